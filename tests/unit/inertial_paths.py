"""Motions in closed form, integrated for an ideal IMU, for tests of inertial navigation."""

import numpy as np

from sdr_spoof.aiding import increments
from sdr_spoof.aiding.records import ImuLog, InertialStates
from sdr_spoof.nav.geodesy import enu_matrix, geodetic_to_ecef

PLACE = (34.0, 108.0, 400.0)
"""Degrees, degrees, m."""


def resting(attitude_rad=(0.3, 0.0, 0.0), place=PLACE, time_s=0.0) -> InertialStates:
    """One state, at rest."""
    return InertialStates(
        None,
        np.array([time_s]),
        geodetic_to_ecef([place]),
        np.zeros((1, 3)),
        np.array([attitude_rad], dtype=np.float64),
        np.zeros(1),
    )


def rest(duration_s: float, rate_hz: float = 100.0, **where) -> tuple[ImuLog, InertialStates]:
    """Increments and the state at the start."""
    start = resting(**where)
    return increments.at_rest(start, duration_s, rate_hz), start


def local(vectors_m, place=PLACE):
    """East, north, up (..., 3) of Earth-fixed vectors."""
    return np.asarray(vectors_m) @ enu_matrix(*place[:2]).T
