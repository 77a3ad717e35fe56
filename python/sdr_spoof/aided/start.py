"""Where the filter begins: place and velocity by GNSS, attitude as given or by alignment."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.tight import Start
from sdr_spoof.errors import AidingError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix
from sdr_spoof.scenario.sky.trajectory import rotations

from . import alone

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import ImuLog, Measurements
    from sdr_spoof.config import Config

    Floats = NDArray[np.float64]

LEVEL_S = 1.0
"""Mean of the specific force that levels."""
LEAST_SPEED_M_S = 2.0
"""Below, the way made good tells no heading."""


def start_of(log: ImuLog, measurements: Measurements, config: Config) -> Start:
    """The state at the first epoch with a fix that increments follow.

    Args:
        log: increments by the clock of the measurements.
        measurements: of the receiver.
        config: its group ``aided``.

    Raises:
        AidingError: there is no such epoch, or nothing tells the heading.
    """
    places = alone.places(measurements)
    velocities = alone.velocities(measurements, places)
    good = np.isfinite(places[:, 0]) & np.isfinite(velocities[:, 0])
    good &= measurements.time_s >= log.time_s[0] - log.interval_s
    good &= measurements.time_s < log.time_s[-1] - LEVEL_S
    if not good.any():
        raise AidingError(
            "no epoch within the IMU's log has a position and a velocity by GNSS to begin with; "
            "give more satellites, with Doppler"
        )
    row = int(np.argmax(good))
    time_s, place, velocity = float(measurements.time_s[row]), places[row], velocities[row]
    attitude = _attitude(log, time_s, place, velocity, config)
    turn = rotations(attitude[None])[0]
    latitude, longitude, _ = ecef_to_geodetic(place)
    ned = enu_matrix(latitude, longitude)[[1, 0, 2]] * np.array([[1.0], [1.0], [-1.0]])
    arm = ned.T @ turn @ np.array(measurements.lever_arm_m)
    swing = ned.T @ turn @ np.cross(_rate_rad_s(log, time_s), measurements.lever_arm_m)
    return Start(time_s, _three(place - arm), _three(velocity - swing), _three(attitude))


def _attitude(
    log: ImuLog, time_s: float, place: Floats, velocity: Floats, config: Config
) -> Floats:
    """Yaw, pitch, roll (3,)."""
    if config.aided.attitude_deg is not None:
        return np.radians(config.aided.attitude_deg)
    latitude, longitude, _ = ecef_to_geodetic(place)
    east, north, _ = enu_matrix(latitude, longitude) @ velocity
    if math.hypot(east, north) < LEAST_SPEED_M_S:
        raise AidingError(
            f"the antenna moves at {math.hypot(east, north):.1f} m/s at the start, which tells no "
            "heading; give --attitude YAW,PITCH,ROLL in degrees, or begin while it moves"
        )
    force = _mean(log, time_s, log.velocity_m_s)
    pitch = math.atan2(force[0], math.hypot(force[1], force[2]))
    roll = math.atan2(-force[1], -force[2])
    return np.array([math.atan2(east, north), pitch, roll])


def _rate_rad_s(log: ImuLog, time_s: float) -> Floats:
    return _mean(log, time_s, log.rotation_rad) / log.interval_s


def _mean(log: ImuLog, time_s: float, values: Floats) -> Floats:
    """Over the second from a time on, a row."""
    rows = (log.time_s > time_s) & (log.time_s <= time_s + LEVEL_S)
    return np.asarray(values[rows if rows.any() else slice(0, 1)].mean(axis=0))


def _three(values: Floats) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
