"""Where the filter begins: place and velocity by GNSS, attitude as given or by alignment.

Without a given attitude the first minute is used to align: at rest, by gravity and the Earth's
turn; in motion, by what the accelerometers sensed of the velocities that GNSS measured. In motion
the antenna swings about the IMU: a first alignment takes that for noise, the second takes it off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.alignment import at_rest
from sdr_spoof.aiding.alignment_fit import MeasuredMotion
from sdr_spoof.aiding.alignment_in_motion import in_motion
from sdr_spoof.aiding.imu.grades import named
from sdr_spoof.aiding.tight import Start
from sdr_spoof.errors import AidingError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix
from sdr_spoof.scenario.sky.trajectory import rotations

from . import alone

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.alignment import Alignment
    from sdr_spoof.aiding.error_growth import AlignmentSigma
    from sdr_spoof.aiding.imu.grades import Grade
    from sdr_spoof.aiding.records import ImuLog, Measurements
    from sdr_spoof.config import Config

    Floats = NDArray[np.float64]

STANDS_M_S = 0.3
"""Median speed below which the antenna is taken to stand still."""
VELOCITY_M_S = 0.1
"""Of a velocity by Doppler, each axis."""
PLACE_M = 3.0
RATE_S = 0.1
"""Mean of the angular rate that makes the antenna swing."""


@dataclass(frozen=True)
class Beginning:
    """A state, how well it is known, and how it was found."""

    start: Start
    sigma: AlignmentSigma | None
    """None where the configuration says it."""
    method: str


def begin(log: ImuLog, measurements: Measurements, config: Config) -> Beginning:
    """The state to begin with.

    Args:
        log: increments by the clock of the measurements.
        measurements: of the receiver.
        config: its groups ``aided`` and ``rate``.

    Raises:
        AidingError: there is no epoch with a fix that increments follow.
        InertialError: the IMU cannot be aligned; the message names the likely mistake.
    """
    motion = _motion(log, measurements)
    arm = np.array(measurements.lever_arm_m)
    if config.aided.attitude_deg is not None:
        attitude = np.radians(config.aided.attitude_deg)
        first = _without_swing(log, _part(motion, 0, 1), attitude[None], arm)
        return Beginning(_start(first, attitude), None, "given")
    grade = named(config.aided.grade or config.rate.grade)
    until_s = motion.time_s[0] + config.aided.align_s
    motion = _part(motion, 0, int(np.searchsorted(motion.time_s, until_s)) + 1)
    last_s = float(motion.time_s[-1])
    if float(np.median(np.linalg.norm(motion.velocity_m_s, axis=1))) < STANDS_M_S:
        place = np.median(motion.position_m, axis=0)
        found = at_rest(log, place, grade, last_s=last_s, position_sigma_m=PLACE_M)
    else:
        found = _moving(log, motion, grade, arm)
    state = found.state
    turn = rotations(state.attitude_rad)[0]
    place = state.position_m[0]
    if found.method.endswith("at rest"):
        place = place - to_earth(place) @ turn @ arm
    start = Start(
        float(state.time_s[0]),
        _three(place),
        _three(state.velocity_m_s[0]),
        _three(state.attitude_rad[0]),
    )
    return Beginning(start, found.sigma, found.method)


def _motion(log: ImuLog, measurements: Measurements) -> MeasuredMotion:
    """The antenna by GNSS at the epochs within the log."""
    places = alone.places(measurements)
    velocities = alone.velocities(measurements, places)
    time_s = measurements.time_s
    good = np.isfinite(places[:, 0]) & np.isfinite(velocities[:, 0])
    good &= (time_s >= log.time_s[0] - log.interval_s) & (time_s <= log.time_s[-1])
    if not good.any():
        raise AidingError(
            "no epoch within the IMU's log has a position and a velocity by GNSS to begin with; "
            "give more satellites, with Doppler"
        )
    return MeasuredMotion(log.reference, time_s[good], places[good], velocities[good])


def _moving(log: ImuLog, motion: MeasuredMotion, grade: Grade, arm: Floats) -> Alignment:
    swing = float(np.sqrt(np.mean((log.rotation_rad / log.interval_s) ** 2)))
    sigma = float(np.hypot(VELOCITY_M_S, swing * np.linalg.norm(arm)))
    found = in_motion(log, motion, grade, velocity_sigma_m_s=sigma, largest_heading_sigma_rad=np.pi)
    if arm.any():
        attitudes = _attitudes(log, motion.time_s, found)
        motion = _without_swing(log, motion, attitudes, arm)
    return in_motion(log, motion, grade, velocity_sigma_m_s=VELOCITY_M_S, position_sigma_m=PLACE_M)


def _attitudes(log: ImuLog, time_s: Floats, found: Alignment) -> Floats:
    """Yaw, pitch, roll at times before the alignment's end, by the gyros alone (K, 3)."""
    turn = rotations(found.state.attitude_rad)[0]
    row = int(np.searchsorted(log.time_s, found.state.time_s[0] + 1e-6)) - 1
    attitudes = np.empty((time_s.size, 3))
    for k in range(time_s.size - 1, -1, -1):
        while row >= 0 and log.time_s[row] > time_s[k] + 0.5 * log.interval_s:
            turn = turn @ _small(-log.rotation_rad[row])
            row -= 1
        attitudes[k] = (
            np.arctan2(turn[1, 0], turn[0, 0]),
            np.arcsin(np.clip(-turn[2, 0], -1.0, 1.0)),
            np.arctan2(turn[2, 1], turn[2, 2]),
        )
    return attitudes


def _small(angle: Floats) -> Floats:
    """Matrix of a small rotation vector, to the second order."""
    x, y, z = angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + cross + 0.5 * cross @ cross)


def _without_swing(
    log: ImuLog, motion: MeasuredMotion, attitude_rad: Floats, arm: Floats
) -> MeasuredMotion:
    """The IMU's point instead of the antenna."""
    if not arm.any():
        return motion
    turns = rotations(attitude_rad)
    places, velocities = motion.position_m.copy(), motion.velocity_m_s.copy()
    for k, time_s in enumerate(motion.time_s):
        axes = to_earth(places[k])
        velocities[k] -= axes @ turns[k] @ np.cross(rate_rad_s(log, time_s), arm)
        places[k] -= axes @ turns[k] @ arm
    return MeasuredMotion(motion.reference, motion.time_s, places, velocities)


def rate_rad_s(log: ImuLog, time_s: float) -> Floats:
    """Angular rate at a time (3,)."""
    first, last = np.searchsorted(log.time_s, [time_s - RATE_S / 2, time_s + RATE_S / 2])
    first = min(first, len(log.time_s) - 1)
    return np.asarray(log.rotation_rad[first : max(last, first + 1)].mean(axis=0) / log.interval_s)


def _part(motion: MeasuredMotion, first: int, last: int) -> MeasuredMotion:
    return MeasuredMotion(
        motion.reference,
        motion.time_s[first:last],
        motion.position_m[first:last],
        motion.velocity_m_s[first:last],
    )


def _start(motion: MeasuredMotion, attitude: Floats) -> Start:
    return Start(
        float(motion.time_s[0]),
        _three(motion.position_m[0]),
        _three(motion.velocity_m_s[0]),
        _three(attitude),
    )


def to_earth(place: Floats) -> Floats:
    """Matrix from north, east, down to Earth-fixed axes."""
    latitude, longitude, _ = ecef_to_geodetic(place)
    east, north, up = enu_matrix(latitude, longitude)
    return np.stack([north, east, -up], axis=-1)


def _three(values: Floats) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in values)
    return x, y, z
