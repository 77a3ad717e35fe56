"""Predicted less measured pseudorange of each satellite: y_j (equation 5), with and without clock.

As it is, y_j contains the receiver's clock, which must be known. ``difference-clock-free`` takes
off what the other satellites say of the clock: their weighted mean.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError

from .statistic import Statistic, normalised

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.geometry import Geometry


def weights(geometry: Geometry) -> NDArray[np.float64]:
    """One row a satellite, (n, m)."""
    return normalised(np.eye(geometry.satellites, len(geometry.sigma_m)), geometry)


def clock_free(geometry: Geometry) -> NDArray[np.float64]:
    """Against the mean of the others, (n, m)."""
    n, m = geometry.satellites, len(geometry.sigma_m)
    if n < 2:
        raise AidingError("one satellite alone tells its clock and nothing else; more are needed")
    of = np.zeros((n, m))
    precision = np.broadcast_to(geometry.sigma_m[:n] ** -2.0, (n, n)) * (1.0 - np.eye(n))
    of[:, :n] = np.eye(n) - precision / precision.sum(1, keepdims=True)
    return normalised(of, geometry)


STATISTIC = Statistic(
    "difference",
    "Pseudorange difference",
    "whether each pseudorange is what the inertial position predicts",
    "a captured INS; it takes a jump of the receiver's clock for an attack",
    weights,
    by_satellite=True,
)
CLOCK_FREE = Statistic(
    "difference-clock-free",
    "Pseudorange difference without clock",
    "whether each pseudorange, against the others, is what the inertial position predicts",
    "a captured INS; an attack that moves all pseudoranges alike, which moves no position",
    clock_free,
    by_satellite=True,
)
