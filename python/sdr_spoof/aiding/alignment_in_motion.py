"""Attitude of a moving body from an IMU and the velocities that GNSS measures.

The arithmetic is in ``rust/core/src/inertial/alignment.rs``: what changes of velocity and gravity
say of the specific force, against what the IMU sensed, over some tens of seconds in which the body
turns or changes its speed. Where no attitude fits, other units, swapped axes and wrong signs are
tried, and the one that does fit is named.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import InertialError
from sdr_spoof.scenario.sky.trajectory import rotations

from . import alignment_checks as checks
from .alignment import LARGEST_HEADING_SIGMA_RAD, Alignment
from .alignment_fit import Fit, MeasuredMotion, Task, reading, task
from .error_growth import AlignmentSigma
from .records import ImuLog, InertialStates

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .imu.grades import Grade

_GRAVITY = checks.STANDARD_GRAVITY
_TURNED_RAD = np.radians(45.0)
"""A body further from level and from its course is taken for one with turned axes."""
_DEGREE = np.pi / 180


def in_motion(
    log: ImuLog,
    motion: MeasuredMotion,
    grade: Grade,
    *,
    velocity_sigma_m_s: float = 0.05,
    position_sigma_m: float = 3.0,
    forward: bool = True,
    largest_heading_sigma_rad: float = LARGEST_HEADING_SIGMA_RAD,
) -> Alignment:
    """Finds the attitude of a body on its way.

    Args:
        log: Increments.
        motion: Places and velocities within them: 20 to 60 s, with a turn or a change of speed.
        grade: Quality of the IMU, for the expected errors and for what is taken for a mistake.
        velocity_sigma_m_s: Of each axis, white; what a lever arm adds in turns included.
        position_sigma_m: Of each axis.
        forward: Whether the body moves roughly along its x axis and upright: an attitude far from
            that is then taken for turned axes and refused.
        largest_heading_sigma_rad: A heading known worse is refused.

    Returns:
        The state at the last epoch within the increments; its sigma is about north, east, down.

    Raises:
        InertialError: IMU and GNSS do not overlap, units or axes seem mistaken (the likely fix is
            named), nothing fits, or the motion does not tell the heading.
    """
    common = task(log, motion, velocity_sigma_m_s)
    _check_unit(common)
    fit = common.fits(reading()[None])[0]
    if fit.scatter_m_s > _allowed(common, grade):
        raise InertialError(_explanation(common, fit, grade, forward))
    if forward:
        _check_turned(fit, common.course())
    sigma = _sigma(common, fit, grade)
    if sigma[2] > largest_heading_sigma_rad:
        raise InertialError(
            f"over {common.length_s:.0f} s the motion tells the heading to "
            f"{np.degrees(sigma[2]):.1f} deg only, {np.degrees(largest_heading_sigma_rad):.1f} are "
            "allowed: take longer, with turns or changes of speed, or a better IMU"
        )
    last = common.epochs[-1]
    state = InertialStates(
        log.reference,
        np.array([common.log.time_s[0] - common.interval_s[0] + last[0]]),
        last[None, 1:4],
        last[None, 4:],
        fit.attitude_rad[None],
        np.zeros(1),
    )
    errors = AlignmentSigma(
        (position_sigma_m,) * 3,
        (velocity_sigma_m_s,) * 3,
        (float(sigma[0]), float(sigma[1]), float(sigma[2])),
    )
    return Alignment(state, errors, f"in motion over {common.length_s:.0f} s")


def _check_unit(common: Task) -> None:
    sensed, wanted = common.forces()
    words = checks.force_unit(sensed, wanted, common.log.interval_s)
    if words is not None:
        raise InertialError(
            f"the accelerometers sense {sensed:.4g} m/s^2 where gravity and the measured "
            f"velocities say {wanted:.4g}: {words}"
        )


def _allowed(common: Task, grade: Grade) -> float:
    """Largest scatter that noise and biases of the grade explain."""
    gyro, accelerometer = _biases(grade)
    length_s = common.length_s
    turned = gyro * length_s + grade.gyro.density * np.sqrt(length_s)
    turned += 3 * (grade.gyro.scale + grade.gyro.misalignment_rad)
    forced = accelerometer + _GRAVITY * (
        grade.accelerometer.scale + grade.accelerometer.misalignment_rad
    )
    drift = length_s * np.hypot(0.1 * forced, 0.05 * _GRAVITY * turned)
    return float(3 * np.hypot(common.velocity_sigma_m_s, drift) + 0.05)


def _biases(grade: Grade) -> tuple[float, float]:
    return (
        float(np.hypot(grade.gyro.bias, grade.gyro.wander)),
        float(np.hypot(grade.accelerometer.bias, grade.accelerometer.wander)),
    )


def _sigma(common: Task, fit: Fit, grade: Grade) -> NDArray[np.float64]:
    """Standard deviations of the attitude about north, east, down: noise, then each bias."""
    variance = common.velocity_sigma_m_s**2 * np.diag(np.linalg.pinv(fit.information))
    gyro, accelerometer = _biases(grade)
    axes = np.eye(3)
    biased = [reading(gyro_bias=gyro * axis) for axis in axes]
    biased += [reading(accelerometer_bias=accelerometer * axis) for axis in axes]
    for other in common.fits(np.array(biased)):
        variance = variance + _turn(fit.attitude_rad, other.attitude_rad) ** 2
    walk = grade.gyro.density**2 * common.length_s / 3
    skew = np.hypot(grade.gyro.misalignment_rad, grade.accelerometer.misalignment_rad)
    return np.asarray(np.sqrt(variance + walk + skew**2))


def _turn(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Small rotation vector from one attitude (yaw, pitch, roll) to another, local axes."""
    a, b = rotations(np.stack([first, second]))
    turn = b @ a.T
    return 0.5 * np.array(
        [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    )


def _explanation(common: Task, fit: Fit, grade: Grade, forward: bool) -> str:
    """Why no attitude fits, and what would."""
    allowed = _allowed(common, grade)
    problem = (
        f"no attitude brings IMU and measured velocities together: {fit.scatter_m_s:.2f} m/s are "
        f"left where {allowed:.2f} are expected"
    )
    degrees = [_DEGREE, 1 / _DEGREE]
    units = common.fits(np.array([reading(gyro=factor) for factor in degrees]))
    words = ("the gyros seem to be in degrees: multiply by pi/180", "multiply the gyros by 180/pi")
    for unit, fix in zip(units, words, strict=True):
        if unit.scatter_m_s < allowed:
            return f"{problem}; {fix}"
    axes = _other_axes(common, allowed, common.course() if forward else None)
    if axes is not None:
        return f"{problem}; with {axes} they do: axes seem to be swapped or turned"
    return (
        f"{problem}, and no other units or axes do: are the clocks of both apart, is the antenna "
        "far from the IMU in turns, or are velocities means over an interval?"
    )


def _other_axes(common: Task, allowed: float, course: float | None) -> str | None:
    """The axes of gyros and accelerometers that do fit, with the fewest changes, in words."""
    ways = checks.signed_axes()
    pairs = [(gyro, sign) for sign in (1.0, -1.0) for gyro in ways]
    fits = common.fits(np.array([reading(gyro, sign) for gyro, sign in pairs]))
    best = min(fit.scatter_m_s for fit in fits)
    if best > allowed:
        return None
    turns = [way for way in ways if np.linalg.det(way) > 0]
    # A turn of the whole IMU fits as well: the right one has it level and along its course.
    choices = [
        (_off_course(fit, turn, course), _changes(turn @ gyro) + _changes(sign * turn), k, j)
        for k, (fit, (gyro, sign)) in enumerate(zip(fits, pairs, strict=True))
        if fit.scatter_m_s < min(1.5 * best + 0.02, allowed)
        for j, turn in enumerate(turns)
    ]
    _, _, k, j = min(choices)
    gyro, sign = pairs[k]
    parts = {"gyro": turns[j] @ gyro, "accelerometer": sign * turns[j]}
    changed = [f"{name} axes {checks.named_axes(p)}" for name, p in parts.items() if _changes(p)]
    return " and ".join(changed) or None


def _changes(way: NDArray[np.float64]) -> int:
    return int((np.diag(way) != 1.0).sum())


def _off_course(fit: Fit, turn: NDArray[np.float64], course: float | None) -> bool:
    """Whether the IMU, turned, would not be level and along its course."""
    if course is None:
        return False
    axes = rotations(fit.attitude_rad[None])[0] @ turn.T
    return bool(_angle(axes, course) > _TURNED_RAD)


def _angle(axes: NDArray[np.float64], course: float) -> float:
    """Between an attitude and level, along a course."""
    wanted = rotations(np.array([[course, 0.0, 0.0]]))[0]
    return float(np.arccos(np.clip((np.trace(wanted.T @ axes) - 1) / 2, -1.0, 1.0)))


def _check_turned(fit: Fit, course: float | None) -> None:
    if course is None:
        return
    axes = rotations(fit.attitude_rad[None])[0]
    if _angle(axes, course) < _TURNED_RAD:
        return
    turns = [way for way in checks.signed_axes() if np.linalg.det(way) > 0]
    likely = min(turns, key=lambda turn: _angle(axes @ turn.T, course))
    raise InertialError(
        f"the body is {np.degrees(_angle(axes, course)):.0f} deg off level along its course: the "
        f"IMU seems to be mounted with other axes; forward, right, down seem to be "
        f"{checks.named_axes(likely)} of it (forward=False takes any attitude)"
    )
