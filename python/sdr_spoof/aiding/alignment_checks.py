"""Mistaken units and axes of an IMU, found by what gravity and the Earth's turn must look like."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import InertialError

from .increments import EARTH_RATE_RAD_S

if TYPE_CHECKING:
    from numpy.typing import NDArray

STANDARD_GRAVITY = 9.80665
_TOLERANCE = 0.05
"""Relative: no calibrated accelerometer is so far off, and no two units are so near."""
_AXES = "xyz"


@dataclass(frozen=True)
class _Unit:
    """A mistake, and what values must be multiplied by to undo it."""

    factor: float
    words: str


def force_unit(length: float, wanted: float, interval_s: float) -> str | None:
    """What is likely to be wrong with the unit of a specific force, in words; None: nothing.

    Args:
        length: As sensed.
        wanted: As it must be, m/s^2 (or both in m/s).
        interval_s: Of the IMU, for increments taken as rates and the reverse.
    """
    if abs(length / wanted - 1) < _TOLERANCE:
        return None
    units = (
        _Unit(STANDARD_GRAVITY, "they seem to be in g: multiply by 9.80665"),
        _Unit(1 / STANDARD_GRAVITY, "g seems to be multiplied in twice: divide by 9.80665"),
        _Unit(STANDARD_GRAVITY / 1000, "they seem to be in mg: multiply by 0.00980665"),
        _Unit(0.3048, "they seem to be in feet: multiply by 0.3048"),
        _Unit(interval_s, "rates seem to be taken as increments: multiply by the interval"),
        _Unit(1 / interval_s, "increments seem to be taken as rates: divide by the interval"),
    )
    off = [abs(length * unit.factor / wanted - 1) for unit in units]
    best = int(np.argmin(off))
    return units[best].words if off[best] < _TOLERANCE else "their unit or scale is unknown"


def check_force(force: NDArray[np.float64], gravity: float, interval_s: float) -> None:
    """Refuses a mean specific force at rest (3,) that is not as long as gravity."""
    length = float(np.linalg.norm(force))
    words = force_unit(length, gravity, interval_s)
    if words is not None:
        raise InertialError(
            f"at rest the accelerometers sense {length:.4g} m/s^2 where gravity is {gravity:.4f}: "
            f"{words}"
        )


def check_level(force: NDArray[np.float64]) -> None:
    """Refuses a mean specific force (3,) that is not roughly along minus z."""
    up = force / np.linalg.norm(force)
    axis = int(np.argmax(np.abs(up)))
    if axis == 2 and up[2] < 0:
        return
    if axis == 2:
        raise InertialError(
            "gravity is sensed as if z pointed up: the axes seem to be forward-left-up or "
            "right-forward-up; forward-right-down are (x, -y, -z) of the first and (y, x, -z) of "
            "the second"
        )
    sign = "" if up[axis] < 0 else "-"
    raise InertialError(
        f"gravity is sensed along {_AXES[axis]}: the axes seem to be swapped, and z, which points "
        f"down, to be {sign}{_AXES[axis]}; with tilted=True any attitude is taken"
    )


def check_rate_unit(length: float, allowed: float, interval_s: float) -> None:
    """Refuses a rate at rest that is the Earth's turn in another unit.

    Args:
        length: Of the mean rate, rad/s.
        allowed: What it may be off by, rad/s.
        interval_s: Of the IMU.
    """
    if allowed > 0.5 * EARTH_RATE_RAD_S or abs(length - EARTH_RATE_RAD_S) <= allowed:
        return
    units = (
        _Unit(np.pi / 180, "they seem to be in degrees: multiply by pi/180"),
        _Unit(np.pi / 180 / 3600, "they seem to be in deg/h: multiply by pi/648000"),
        _Unit(interval_s, "rates seem to be taken as increments: multiply by the interval"),
        _Unit(1 / interval_s, "increments seem to be taken as rates: divide by the interval"),
        _Unit(180 / np.pi, "pi/180 seems to be multiplied in twice: multiply by 180/pi"),
    )
    off = [abs(length * unit.factor / EARTH_RATE_RAD_S - 1) for unit in units]
    best = int(np.argmin(off))
    if off[best] < 0.1 + allowed / EARTH_RATE_RAD_S:
        raise InertialError(f"{_rate_words(length, allowed)}: {units[best].words}")


def check_rate(
    rate: NDArray[np.float64], up: NDArray[np.float64], latitude: float, allowed: float
) -> None:
    """Refuses a mean rate at rest that is not the Earth's turn.

    Args:
        rate: Of the gyros, rad/s, (3,).
        up: By the accelerometers, body axes, a unit vector (3,).
        latitude: rad.
        allowed: What it may be off by, rad/s.
    """
    length = float(np.linalg.norm(rate))
    if abs(length - EARTH_RATE_RAD_S) > allowed:
        raise InertialError(
            f"{_rate_words(length, allowed)}: it moves, or its gyros are worse than their grade"
        )
    vertical = float(rate @ up)
    wanted = EARTH_RATE_RAD_S * np.sin(latitude)
    if abs(vertical - wanted) > allowed:
        opposite = abs(vertical + wanted) <= allowed
        fix = "its sign seems to be wrong" if opposite else "gyro axes seem to be swapped"
        raise InertialError(
            f"the gyros sense {_per_hour(vertical):.2f} deg/h about the vertical that the "
            f"accelerometers see, where the Earth turns by {_per_hour(wanted):.2f}: {fix}"
        )


def _rate_words(length: float, allowed: float) -> str:
    return (
        f"at rest the gyros sense {_per_hour(length):.4g} deg/h where the Earth turns by 15.04 and "
        f"their grade allows {_per_hour(allowed):.2g} beside"
    )


def _per_hour(rate_rad_s: float) -> float:
    return float(np.degrees(rate_rad_s) * 3600)


def signed_axes() -> NDArray[np.float64]:
    """All 48 ways to swap and turn axes, (48, 3, 3), the given one first."""
    ways = [
        np.diag(signs)[list(order)]
        for order in itertools.permutations(range(3))
        for signs in itertools.product((1.0, -1.0), repeat=3)
    ]
    return np.array(ways)


def named_axes(way: NDArray[np.float64]) -> str:
    """How new axes are made of old ones, such as (y, x, -z)."""
    parts = []
    for row in way:
        axis = int(np.argmax(np.abs(row)))
        parts.append(("-" if row[axis] < 0 else "") + _AXES[axis])
    return f"({', '.join(parts)})"
