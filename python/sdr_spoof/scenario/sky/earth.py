"""Local axes and plane maps of a piece of the Earth, for trajectories.

Places are latitude and longitude in degrees and height in m, as in :mod:`sdr_spoof.nav.geodesy`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.geodesy import ecef_to_geodetic

if TYPE_CHECKING:
    from numpy.typing import NDArray

SEMI_MAJOR_M = 6_378_137.0
_FLATTENING = 1 / 298.257223563
"""WGS 84 (NIMA TR8350.2, table 3.1)."""
_E2 = _FLATTENING * (2 - _FLATTENING)


def enu_axes(position_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors east, north, up (N, 3, 3), one a row, Earth-fixed, at positions (N, 3)."""
    latitude, longitude, _ = ecef_to_geodetic(position_m).T
    b, l = np.radians(latitude), np.radians(longitude)  # noqa: E741
    (sin_b, cos_b), (sin_l, cos_l) = (np.sin(b), np.cos(b)), (np.sin(l), np.cos(l))
    east = np.stack([-sin_l, cos_l, np.zeros_like(sin_l)], axis=-1)
    north = np.stack([-sin_b * cos_l, -sin_b * sin_l, cos_b], axis=-1)
    up = np.stack([cos_b * cos_l, cos_b * sin_l, sin_b], axis=-1)
    return np.stack([east, north, up], axis=-2)


def from_plane(origin: NDArray[np.float64], enu_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places (N, 3) of east, north, up (N, 3) along the ellipsoid from a place (3,)."""
    return np.asarray(origin + enu_m[:, [1, 0, 2]] * _per_metre(origin))


def to_plane(origin: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """The opposite of :func:`from_plane`."""
    return np.asarray(((places - origin) / _per_metre(origin))[:, [1, 0, 2]])


def stretch(origin: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """True metres east, north, up (N, 3) a metre of the plane about a place, at places (N, 3)."""
    true, plane = degrees_a_metre(places), _per_metre(origin)
    return np.asarray((plane / true)[:, [1, 0, 2]])


def _per_metre(origin: NDArray[np.float64]) -> NDArray[np.float64]:
    """Degrees a metre to the north and to the east, and 1."""
    return np.asarray(degrees_a_metre(origin[None])[0])


def degrees_a_metre(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """North, east and up (1) at places (N, 3)."""
    latitude, height = np.radians(places[:, 0]), places[:, 2]
    root = np.sqrt(1 - _E2 * np.sin(latitude) ** 2)
    north = SEMI_MAJOR_M * (1 - _E2) / root**3 + height
    east = (SEMI_MAJOR_M / root + height) * np.cos(latitude)
    return np.stack([np.degrees(1 / north), np.degrees(1 / east), np.ones_like(north)], axis=-1)
