"""What a perfect IMU senses along a trajectory, and where it truly is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicSpline

from sdr_spoof import _core
from sdr_spoof.errors import ConfigError
from sdr_spoof.nav.geodesy import ecef_to_geodetic
from sdr_spoof.scenario.sky import earth
from sdr_spoof.scenario.sky.trajectory import OnPlane

from ..records import ImuLog, InertialStates

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.scenario.sky.trajectory import Trajectory

_KNOTS_HZ = 100.0
"""Fewest knots a second of the spline that stands for the motion."""
_JUMP_RAD = 0.2
"""Between knots no body turns so far."""


def ideal_increments(
    trajectory: Trajectory,
    duration_s: float,
    rate_hz: float,
    *,
    start_s: float = 0.0,
    reference: GnssTime | None = None,
) -> ImuLog:
    """Increments of a perfect IMU at the body's point (not the antenna).

    A cubic spline through the trajectory at every interval (at 100 Hz or more) stands for the
    motion; its angular rate against inertial space and its specific force, with the normal gravity
    that the strapdown computer uses, are integrated over each interval.

    Args:
        trajectory: Motion and attitude.
        duration_s: Length.
        rate_hz: Rate of the increments.
        start_s: Start of the first interval, in the trajectory's time.
        reference: What the times count from, passed on.

    Returns:
        N = floor(duration x rate) increments; times are the ends of their intervals.

    Raises:
        ConfigError: the attitude jumps, as it does where a trajectory without one stands still.
    """
    interval_s = 1.0 / rate_hz
    per = math.ceil(_KNOTS_HZ * interval_s - 1e-9)
    count = math.floor(duration_s * rate_hz + 1e-6)
    time_s = start_s + np.arange(count * per + 1, dtype=np.float64) * (interval_s / per)
    origin, offsets = _on_ellipsoid(trajectory, time_s)
    six = np.hstack([offsets, _attitude(trajectory, time_s)])
    rates = CubicSpline(time_s - time_s[0], six)(time_s - time_s[0], 1)
    knots = np.hstack([six, rates])
    rotation, velocity = _core.imu_increments(
        origin.tolist(), np.ascontiguousarray(knots), interval_s / per, per
    )
    ends_s = start_s + np.arange(1, count + 1, dtype=np.float64) * interval_s
    return ImuLog(reference, ends_s, interval_s, rotation, velocity)


def true_states(
    trajectory: Trajectory, time_s: NDArray[np.float64], *, reference: GnssTime | None = None
) -> InertialStates:
    """The states of a body's point, as an INS without errors has them.

    Args:
        trajectory: Motion and attitude.
        time_s: Times of the trajectory (M,).
        reference: What the times count from, passed on.
    """
    return InertialStates(
        reference,
        time_s,
        trajectory.body(time_s),
        trajectory.body_velocity_m_s(time_s),
        trajectory.attitude_rad(time_s),
        np.zeros_like(time_s),
    )


def _on_ellipsoid(
    trajectory: Trajectory, time_s: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A place (rad, rad, m), and latitude, longitude, height of the body beyond it (N, 3)."""
    unit = np.array([math.radians(1.0), math.radians(1.0), 1.0])
    if isinstance(trajectory.body, OnPlane):
        plane = trajectory.body
        places = plane.enu_m(time_s)[:, [1, 0, 2]] * earth.degrees_a_metre(plane.origin[None])
        return plane.origin * unit, places * unit
    places = ecef_to_geodetic(trajectory.body(time_s))
    offsets = places - places[0]
    offsets[:, 1] = (offsets[:, 1] + 180.0) % 360.0 - 180.0
    return places[0] * unit, offsets * unit


def _attitude(trajectory: Trajectory, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    attitude = np.unwrap(trajectory.attitude_rad(time_s), axis=0)
    turn = np.abs(np.diff(attitude, axis=0)).max(axis=1, initial=0.0)
    if turn.size and turn.max() > _JUMP_RAD:
        raise ConfigError(
            f"the attitude of the trajectory jumps by {math.degrees(turn.max()):.0f} degrees at "
            f"{time_s[turn.argmax()]:.2f} s, which no gyro could follow; give yaw_deg, pitch_deg "
            "and roll_deg in its file, or another kind of trajectory"
        )
    return np.asarray(attitude)
