"""Where the antenna is at any time: runtime side of the trajectories.

Times are seconds of system time since the scenario's ``start``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicSpline

from sdr_spoof.nav.geodesy import geodetic_to_ecef

from . import earth

if TYPE_CHECKING:
    from numpy.typing import NDArray

Curve = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
"""From times (N,) to vectors (N, 3)."""

_DELTA_S = 1e-3
_PLANE_DELTA_S = 2e-4
"""Where coordinates are small, and rounded to 1e-12 m."""
_STANDS_M_S = 1e-3


@dataclass(frozen=True)
class OnPlane:
    """Earth-fixed positions of a curve in east, north, up about a place."""

    origin: NDArray[np.float64]
    """Latitude and longitude in degrees, height in m, (3,)."""
    enu_m: Curve
    """Along the ellipsoid: see :func:`.earth.from_plane`."""

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Earth-fixed, (N, 3)."""
        return geodetic_to_ecef(earth.from_plane(self.origin, self.enu_m(time_s)))

    def velocity_enu_m_s(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """True east, north, up components (N, 3)."""
        rate = _rate(self.enu_m, time_s, _PLANE_DELTA_S)
        places = earth.from_plane(self.origin, self.enu_m(time_s))
        return np.asarray(rate * earth.stretch(self.origin, places))


@dataclass(frozen=True)
class Trajectory:
    """A body that moves, and an antenna on it."""

    body: Curve
    """Earth-fixed position in m."""
    turned: Curve | None = None
    """Yaw (from north to east), pitch, roll in rad; None: level, along the way."""
    lever_arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Antenna from the body's point: forward, right, down."""

    def position_m(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Earth-fixed position of the antenna, (N, 3)."""
        position = self.body(time_s)
        if not any(self.lever_arm_m):
            return position
        axes = earth.enu_axes(position)
        forward_right_down = rotations(self.attitude_rad(time_s)) @ np.array(self.lever_arm_m)
        north, east, down = forward_right_down.T
        enu = np.stack([east, north, -down], axis=-1)
        return np.asarray(position + np.einsum("nk,nkx->nx", enu, axes))

    def velocity_m_s(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Earth-fixed velocity of the antenna, (N, 3)."""
        return _rate(self.position_m, time_s)

    def body_velocity_m_s(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Earth-fixed velocity of the body's point, (N, 3)."""
        if isinstance(self.body, OnPlane):
            axes = earth.enu_axes(self.body(time_s))
            enu = self.body.velocity_enu_m_s(time_s)
            return np.asarray(np.einsum("nk,nkx->nx", enu, axes))
        return _rate(self.body, time_s)

    def attitude_rad(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Yaw, pitch, roll, (N, 3)."""
        if self.turned is not None:
            return self.turned(time_s)
        axes = earth.enu_axes(self.body(time_s))
        velocity = self.body_velocity_m_s(time_s)
        east, north, _ = np.einsum("nkx,nx->nk", axes, velocity).T
        moves = np.hypot(east, north) > _STANDS_M_S
        yaw = np.where(moves, np.arctan2(east, north), 0.0)
        return np.stack([yaw, np.zeros_like(yaw), np.zeros_like(yaw)], axis=-1)


def rotations(attitude_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrices (N, 3, 3) from forward, right, down to north, east, down: yaw, pitch, roll."""
    (cy, cp, cr), (sy, sp, sr) = np.cos(attitude_rad).T, np.sin(attitude_rad).T
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def along(enu_m: Curve, time_s: NDArray[np.float64]) -> Curve:
    """Level, and along a way on a plane; where it stands, as it came to stand.

    Args:
        enu_m: The way.
        time_s: Times (N,) to look at it, ascending.
    """
    east, north, _ = _rate(enu_m, time_s, _PLANE_DELTA_S).T
    moves = np.hypot(east, north) > _STANDS_M_S
    if not moves.any():
        return lambda at_s: np.zeros((np.size(at_s), 3))
    last = np.maximum.accumulate(np.where(moves, np.arange(time_s.size), 0))
    last = np.where(moves[last], last, np.argmax(moves))
    yaw = np.unwrap(np.arctan2(east, north)[last])
    return through(time_s, np.stack([yaw, np.zeros_like(yaw), np.zeros_like(yaw)], axis=-1))


def through(time_s: NDArray[np.float64], values: NDArray[np.float64]) -> Curve:
    """A cubic spline through vectors (N, 3); straight on beyond its ends."""
    middle = values.mean(axis=0)
    spline = CubicSpline(time_s, values - middle)
    rate = spline.derivative()

    def curve(at_s: NDArray[np.float64]) -> NDArray[np.float64]:
        inside = np.clip(at_s, time_s[0], time_s[-1])
        beyond = (at_s - inside)[:, None]
        return np.asarray(middle + spline(inside) + beyond * rate(inside))

    return curve


def _rate(
    curve: Curve, time_s: NDArray[np.float64], delta_s: float = _DELTA_S
) -> NDArray[np.float64]:
    """Central difference: off by (third derivative) delta^2 / 6, and by the rounding over delta."""
    return np.asarray((curve(time_s + delta_s) - curve(time_s - delta_s)) / (2 * delta_s))
