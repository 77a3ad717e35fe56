"""Where an INS begins: a given state, one found at rest, or one found by course.

At rest, gravity gives the level and the Earth's turn the heading (P. D. Groves, Principles of GNSS,
Inertial, and Multisensor Integrated Navigation Systems, 2nd ed. (2013), section 5.6). What biases
leave is stated: b / g of tilt, eps / (Omega cos(latitude)) of heading. In motion see
:mod:`alignment_in_motion`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import InertialError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix, radians

from . import alignment_checks as checks
from . import increments
from .error_growth import AlignmentSigma
from .increments import EARTH_RATE_RAD_S
from .records import ImuLog, InertialStates

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime

    from .imu.grades import Grade, SensorGrade

LARGEST_HEADING_SIGMA_RAD = float(np.radians(5.0))
"""An alignment that knows the heading no better is refused unless told otherwise."""
_STILL_RAD_S = 2e-3
_STILL_M_S2 = 0.05
"""Means over a second that differ by more are motion."""


@dataclass(frozen=True)
class Alignment:
    """A state to begin with, and how well it is known."""

    state: InertialStates
    """One row."""
    sigma: AlignmentSigma
    """Expected errors, standard deviations."""
    method: str
    """In words."""


@dataclass(frozen=True)
class Rest:
    """Means over a time at rest."""

    force: NDArray[np.float64]
    """Specific force, m/s^2, (3,)."""
    rate: NDArray[np.float64]
    """rad/s, (3,)."""
    length_s: float
    end_s: float
    shaken_m_s2: float
    """Largest difference of a mean over a second from the others."""
    turned_rad_s: float
    """Likewise."""


def given(state: InertialStates, sigma: AlignmentSigma | None = None) -> Alignment:
    """A state that is known from elsewhere (one row)."""
    if len(state.time_s) != 1:
        raise InertialError(f"a given state has one row, not {len(state.time_s)}")
    return Alignment(state, sigma or AlignmentSigma(), "given")


def at_rest(
    log: ImuLog,
    position_m: NDArray[np.float64],
    grade: Grade,
    *,
    first_s: float | None = None,
    last_s: float | None = None,
    heading_rad: float | None = None,
    heading_sigma_rad: float = 0.0,
    position_sigma_m: float = 0.0,
    tilted: bool = False,
    largest_heading_sigma_rad: float = LARGEST_HEADING_SIGMA_RAD,
) -> Alignment:
    """Levels and finds north with an IMU that stands still.

    Args:
        log: Increments.
        position_m: Earth-fixed, (3,).
        grade: Quality of the IMU, for the expected errors and for what is taken for a mistake.
        first_s: Where standing still begins; None: with the log.
        last_s: Where it ends; None: with the log.
        heading_rad: Yaw if it is known; None: found from the Earth's turn.
        heading_sigma_rad: What a known heading may be off by.
        position_sigma_m: Of each axis.
        tilted: Whether the body may stand on its side or head; by default that is taken for
            swapped or turned axes and refused.
        largest_heading_sigma_rad: A heading found worse than this is refused.

    Returns:
        The state at the end of the time at rest.

    Raises:
        InertialError: it moves, units or axes seem mistaken, or gyros cannot find north.
    """
    rest = at_rest_means(log, first_s, last_s)
    latitude, _, height_m = radians(ecef_to_geodetic(position_m))[0]
    gravity = float(_core.normal_gravity(np.array([latitude]), np.array([height_m]))[0])
    up = rest.force / np.linalg.norm(rest.force)
    _check_rest(rest, grade, log.interval_s, (latitude, gravity), tilted)
    tilt = float(np.hypot(_sigma(grade.accelerometer, rest.length_s) / gravity, _skew(grade)))
    if heading_rad is None:
        heading_sigma_rad = compass_sigma_rad(grade, latitude, rest.length_s, tilt)
        _check_compass(grade, heading_sigma_rad, largest_heading_sigma_rad)
        attitude = _triad(-up, rest.rate)
    else:
        attitude = levelled(-up, heading_rad)
    state = InertialStates(
        log.reference,
        np.array([rest.end_s]),
        np.array(position_m, np.float64).reshape(1, 3),
        np.zeros((1, 3)),
        attitude[None],
        np.zeros(1),
    )
    sigma = AlignmentSigma(
        (position_sigma_m,) * 3, (0.0, 0.0, 0.0), (tilt, tilt, heading_sigma_rad)
    )
    way = "levelled, heading given" if heading_rad is not None else "levelled, gyro-compassed"
    return Alignment(state, sigma, f"{way} over {rest.length_s:.0f} s at rest")


def at_rest_means(log: ImuLog, first_s: float | None, last_s: float | None) -> Rest:
    """Means of an IMU at rest.

    Raises:
        InertialError: what :func:`increments.check` raises, or less than 2 s.
    """
    increments.check(log)
    chosen = np.ones(len(log.time_s), bool)
    chosen &= True if first_s is None else log.time_s > first_s
    chosen &= True if last_s is None else log.time_s <= last_s
    per_second = round(1 / log.interval_s)
    seconds = int(chosen.sum()) // per_second
    if seconds < 2:
        raise InertialError(
            f"{chosen.sum() * log.interval_s:.2f} s at rest are too few for an alignment: give a "
            "minute where you can, and 2 s at least"
        )
    last = np.flatnonzero(chosen)[-seconds * per_second :]
    interval_s = increments.intervals_s(log)[last].reshape(seconds, -1).sum(axis=1)[:, None]
    force = log.velocity_m_s[last].reshape(seconds, -1, 3).sum(axis=1) / interval_s
    rate = log.rotation_rad[last].reshape(seconds, -1, 3).sum(axis=1) / interval_s
    return Rest(
        force.mean(axis=0),
        rate.mean(axis=0),
        float(interval_s.sum()),
        float(log.time_s[last[-1]]),
        float(np.abs(force - np.median(force, axis=0)).max()),
        float(np.abs(rate - np.median(rate, axis=0)).max()),
    )


def _check_rest(
    rest: Rest, grade: Grade, interval_s: float, where: tuple[float, float], tilted: bool
) -> None:
    """Units first, which would look like motion; then motion, then axes."""
    latitude, gravity = where
    allowed = 5 * _sigma(grade.gyro, rest.length_s) + 0.02 * EARTH_RATE_RAD_S
    checks.check_force(rest.force, gravity, interval_s)
    checks.check_rate_unit(float(np.linalg.norm(rest.rate)), allowed, interval_s)
    if rest.shaken_m_s2 > _STILL_M_S2 or rest.turned_rad_s > _STILL_RAD_S:
        raise InertialError(
            f"the IMU moves: means over a second change by {rest.shaken_m_s2:.3f} m/s^2 and "
            f"{np.degrees(rest.turned_rad_s):.3f} deg/s; stand still, choose another time, or "
            "align in motion"
        )
    if not tilted:
        checks.check_level(rest.force)
    checks.check_rate(rest.rate, rest.force / np.linalg.norm(rest.force), latitude, allowed)


def _sigma(grade: SensorGrade, length_s: float) -> float:
    """What a sensor's mean over some seconds is off by."""
    return float(np.sqrt(grade.bias**2 + grade.wander**2 + grade.density**2 / length_s))


def _skew(grade: Grade) -> float:
    """Misaligned accelerometers are tilted."""
    return grade.accelerometer.misalignment_rad


def compass_sigma_rad(grade: Grade, latitude: float, length_s: float, tilt: float) -> float:
    """Standard deviation of a heading found from the Earth's turn: eps / (Omega cos(latitude)),
    and what the tilt and misaligned gyros mix in of the vertical turn."""
    level = EARTH_RATE_RAD_S * np.cos(latitude)
    mixed = np.hypot(tilt, grade.gyro.misalignment_rad) * np.tan(latitude)
    return float(np.hypot(_sigma(grade.gyro, length_s) / level, mixed))


def _check_compass(grade: Grade, sigma_rad: float, largest_rad: float) -> None:
    if sigma_rad > largest_rad:
        raise InertialError(
            f"gyros of grade '{grade.name}' find north to {np.degrees(sigma_rad):.1f} deg only, "
            f"{np.degrees(largest_rad):.1f} are allowed: give a heading, or align in motion"
        )


def _triad(down: NDArray[np.float64], rate: NDArray[np.float64]) -> NDArray[np.float64]:
    """Yaw, pitch, roll from the directions of down and of the Earth's turn in body axes."""
    north = rate - (rate @ down) * down
    north /= np.linalg.norm(north)
    return attitude_of(np.stack([north, np.cross(down, north), down]))


def levelled(down: NDArray[np.float64], yaw: float) -> NDArray[np.float64]:
    """Yaw, pitch, roll (3,) from down in body axes, a unit vector (3,), and a known yaw."""
    pitch = np.arcsin(np.clip(-down[0], -1.0, 1.0))
    return np.array([yaw, pitch, np.arctan2(down[1], down[2])])


def attitude_of(axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Yaw, pitch, roll (3,) of a matrix (3, 3) from body to north, east, down."""
    yaw = np.arctan2(axes[1, 0], axes[0, 0])
    pitch = np.arcsin(np.clip(-axes[2, 0], -1.0, 1.0))
    return np.array([yaw, pitch, np.arctan2(axes[2, 1], axes[2, 2])])


def from_course(
    time_s: float,
    position_m: NDArray[np.float64],
    velocity_m_s: NDArray[np.float64],
    *,
    reference: GnssTime | None = None,
    velocity_sigma_m_s: float = 0.05,
    position_sigma_m: float = 3.0,
    slip_rad: float = 0.035,
    roll_rad: float = 0.05,
) -> Alignment:
    """Takes the body for level across and pointed along its velocity: a vehicle on wheels.

    Args:
        time_s: Of the state.
        position_m: Earth-fixed, (3,).
        velocity_m_s: Earth-fixed, (3,).
        reference: What the time counts from.
        velocity_sigma_m_s: Of each axis.
        position_sigma_m: Of each axis.
        slip_rad: What heading and course differ by (side slip, mounting), standard deviation.
        roll_rad: What roll and pitch may be off by.

    Raises:
        InertialError: too slow for a course.
    """
    latitude, longitude, _ = ecef_to_geodetic(position_m)
    east, north, up = enu_matrix(latitude, longitude) @ velocity_m_s
    speed = float(np.hypot(east, north))
    if speed < 20 * velocity_sigma_m_s or speed < 1.0:
        raise InertialError(
            f"at {speed:.2f} m/s the course does not tell the heading: wait until it drives faster "
            f"than {max(20 * velocity_sigma_m_s, 1.0):.1f} m/s"
        )
    attitude = np.array([[np.arctan2(east, north), np.arctan2(up, speed), 0.0]])
    heading = float(np.hypot(velocity_sigma_m_s / speed, slip_rad))
    state = InertialStates(
        reference,
        np.array([time_s]),
        np.array(position_m, np.float64).reshape(1, 3),
        np.array(velocity_m_s, np.float64).reshape(1, 3),
        attitude,
        np.zeros(1),
    )
    sigma = AlignmentSigma(
        (position_sigma_m,) * 3, (velocity_sigma_m_s,) * 3, (roll_rad, roll_rad, heading)
    )
    return Alignment(state, sigma, "level, along its course")
