"""The parity vector: what no error of position and clocks explains.

The rows of W y that are orthogonal to W G, in an orthonormal basis: m - 5 channels (n - 4 of GNSS
alone), independent and normal under H0. No capture of the INS hides in it, and no false trajectory
shows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError

from .statistic import Statistic

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.geometry import Geometry


def weights(geometry: Geometry) -> NDArray[np.float64]:
    """An orthonormal basis, (m - 5, m); the sign of each row is fixed by its largest weight."""
    geometry.check()
    rows, unknowns = geometry.design.shape
    if rows == unknowns:
        raise AidingError(
            f"{geometry.satellites} satellites are as many as there are unknowns: nothing is left "
            "to compare; more are needed"
        )
    left, _, _ = np.linalg.svd(geometry.normalised(), full_matrices=True)
    basis = left[:, unknowns:].T
    largest = np.take_along_axis(basis, np.abs(basis).argmax(1)[:, None], 1)
    return np.asarray(basis * np.sign(largest) / geometry.sigma_m)


STATISTIC = Statistic(
    "parity",
    "Parity vector",
    "whether the satellites agree with each other",
    "attacks on all satellites together: a false trajectory, a clock attack; with as many "
    "satellites as unknowns it does not exist",
    weights,
    by_satellite=False,
)
