"""Earth-fixed coordinates: geodetic, local and topocentric; the arithmetic is in the core."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from .. import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Ellipsoid = Literal["WGS-84", "CGCS2000"]
"""They differ by 0.1 mm in height at most."""


def ecef_to_geodetic(ecef_m: ArrayLike, ellipsoid: Ellipsoid = "WGS-84") -> NDArray[np.float64]:
    """Latitude and longitude in degrees and height in m (..., 3) of coordinates in m (..., 3)."""
    points = np.asarray(ecef_m, np.float64)
    place = _core.geodetic(_rows(points, 3), ellipsoid)
    place[:, :2] = np.degrees(place[:, :2])
    return place.reshape(points.shape)


def geodetic_to_ecef(place: ArrayLike, ellipsoid: Ellipsoid = "WGS-84") -> NDArray[np.float64]:
    """Coordinates in m (..., 3) of latitude and longitude in degrees and height in m (..., 3)."""
    places = np.asarray(place, np.float64)
    return _core.ecef(radians(places), ellipsoid).reshape(places.shape)


def radians(place: ArrayLike) -> NDArray[np.float64]:
    """Rows of latitude, longitude, height with angles in rad (N, 3), from degrees (..., 3)."""
    rows = _rows(np.asarray(place, np.float64), 3).copy()
    rows[:, :2] = np.radians(rows[:, :2])
    return rows


def enu_matrix(latitude_deg: float, longitude_deg: float) -> NDArray[np.float64]:
    """Rows east, north, up (3, 3): turns Earth-fixed vectors into local ones."""
    b, l = np.radians([latitude_deg, longitude_deg])  # noqa: E741
    sin_b, cos_b, sin_l, cos_l = np.sin(b), np.cos(b), np.sin(l), np.cos(l)
    return np.array(
        [
            [-sin_l, cos_l, 0.0],
            [-sin_b * cos_l, -sin_b * sin_l, cos_b],
            [cos_b * cos_l, cos_b * sin_l, sin_b],
        ]
    )


def enu(points_m: ArrayLike, origin_m: ArrayLike) -> NDArray[np.float64]:
    """East, north, up (..., 3) in m of Earth-fixed points seen from an origin (3,)."""
    origin = np.asarray(origin_m, np.float64)
    latitude, longitude, _ = ecef_to_geodetic(origin)
    return (np.asarray(points_m, np.float64) - origin) @ enu_matrix(latitude, longitude).T


def azimuth_elevation(receiver_m: ArrayLike, target_m: ArrayLike) -> NDArray[np.float64]:
    """Azimuth in [0, 360) from north through east and elevation, degrees (..., 2).

    Args:
        receiver_m: Earth-fixed, m, (..., 3) or (3,) for all.
        target_m: likewise.
    """
    receiver, target = np.broadcast_arrays(
        np.asarray(receiver_m, np.float64), np.asarray(target_m, np.float64)
    )
    angles = _core.azimuth_elevation(_rows(receiver, 3), _rows(target, 3))
    return np.degrees(angles).reshape(*receiver.shape[:-1], 2)


def _rows(values: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    return np.ascontiguousarray(values.reshape(-1, width))
