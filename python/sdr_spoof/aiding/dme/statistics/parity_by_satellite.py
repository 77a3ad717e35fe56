"""What is left of each satellite after least squares of all, normalised.

Row j of the projector onto the parity space, over its size: the part of the parity vector that an
error of satellite j would make. Unlike the parity vector's own axes, which turn with the geometry,
it goes on from epoch to epoch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import parity
from .statistic import Statistic

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.geometry import Geometry

LEAST_SEEN = 0.05
"""Share of an error that must remain for it to be tested; others are NaN."""


def weights(geometry: Geometry) -> NDArray[np.float64]:
    """One row a satellite, (n, m)."""
    basis = parity.weights(geometry)
    projector = (basis * geometry.sigma_m).T @ basis
    seen = np.sqrt(np.clip(np.diag(projector * geometry.sigma_m[:, None]), 0.0, None))
    size = np.where(seen > LEAST_SEEN, seen, np.nan)
    return np.asarray((projector / size[:, None])[: geometry.satellites])


STATISTIC = Statistic(
    "parity-by-satellite",
    "Residual of each satellite",
    "whether each satellite agrees with the others",
    parity.STATISTIC.blind_to,
    weights,
    by_satellite=True,
)
