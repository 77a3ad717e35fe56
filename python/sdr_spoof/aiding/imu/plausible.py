"""Whether units and axes of an IMU can be what they are said to be.

Gravity tells the unit of the accelerometers and which axis is down. Gyros have no such yardstick;
what they say is held against what the accelerometers say of the same motion:

- where a body tilts, the direction of the specific force turns by as much the other way;
- where it turns at a speed v, it feels v times the rate to the side.

Both hold on average only: cars lean outwards, aircraft bank. So a file is refused only where the
answer is clear and fits a known mistake; otherwise a note says that nothing could be told.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import InertialError

from .rows import ACCEL_UNITS, GYRO_UNITS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .rows import ImuRows, Unit

_GRAVITY_M_S2 = (8.5, 11.5)
"""Median of what accelerometers feel on anything that does not fly aerobatics."""
_NO_GRAVITY_M_S2 = 2.0
_PLUMB = 0.8
"""Share of the mean specific force along one axis that tells which one is down."""
_FASTEST_RAD_S = 1.0
"""Largest rms rate over a whole file: 57 deg/s."""
_WINDOW_S = 1.0
_TILT_RAD = 0.003
"""Least rms tilt from window to window that can be compared."""
_BOTH = 0.05
"""Least tilt about one axis against that about the other: both must be told."""
_LEAST_WINDOWS = 10
_SIDE_M_S2 = 0.1
"""Least rms of what is felt to the side that can be compared."""
_SURE = 0.8
"""Squared correlation of what two sensors say of the same motion, to be believed."""
_SPEEDS_M_S = (0.6, 340.0)
"""Speeds at which vehicles make turns that are felt."""
_SAME = (0.6, 1.6)
"""Gains that are one."""
_ALIKE = 0.5
_DEGREES = math.degrees(1.0)
_SCALES = "are the scale factors those of this IMU?"


def plausible(rows: ImuRows) -> list[str]:
    """Notes on what could not be told.

    Raises:
        InertialError: gravity is not felt, or along the wrong axis; the gyros contradict the
            accelerometers. The message names the likely mistake.
    """
    _unit_of_force(rows)
    down = _down(rows)
    if down is None:
        return ["no axis is plumb: whether the axes are right could not be told"]
    _fastest(rows)
    told = _tilts(rows, down)
    told |= _turns(rows)
    return [] if told else ["too little motion to tell whether the gyros' unit is right"]


def _unit_of_force(rows: ImuRows) -> None:
    felt = float(np.median(np.linalg.norm(rows.force_m_s2, axis=1)))
    if _GRAVITY_M_S2[0] <= felt <= _GRAVITY_M_S2[1]:
        return
    raw = felt / _per_second(rows.accel_unit, rows.interval_s)
    others = [
        u.name
        for u in ACCEL_UNITS
        if _GRAVITY_M_S2[0] <= raw * _per_second(u, rows.interval_s) <= _GRAVITY_M_S2[1]
    ]
    hint = _SCALES
    if others:
        hint = f"the values look like {' or '.join(others)}: name the columns accel_x_{others[0]}"
    elif felt < _NO_GRAVITY_M_S2:
        hint = "has gravity been taken off? Give what the accelerometers themselves say"
    raise InertialError(
        f"{rows.origin}: the accelerometers, in {rows.accel_unit.name}, feel {felt:.3g} m/s^2 at "
        f"rest, where gravity is 9.8; {hint}"
    )


def _per_second(unit: Unit, interval_s: float) -> float:
    """Size of a unit as a rate."""
    return unit.size / interval_s if unit.increment else unit.size


def _down(rows: ImuRows) -> NDArray[np.float64] | None:
    """Unit vector of the mean specific force, which must be along minus z; None: no axis is."""
    mean = rows.force_m_s2.mean(axis=0)
    up = mean / np.linalg.norm(mean)
    axis = int(np.argmax(np.abs(up)))
    if abs(up[axis]) < _PLUMB:
        return None
    if axis == 2 and up[2] < 0:
        return np.asarray(up)
    name = "xyz"[axis]
    sense = "up" if up[axis] > 0 else "down"
    hint = "give axes = FLU (forward, left, up), RFU, or whatever they are"
    if axis != 2:
        hint = f"give axes with {sense[0].upper()} in place {axis + 1}, or correct the columns"
    raise InertialError(
        f"{rows.origin}: gravity is felt along the {name} axis, which so points {sense}, where the "
        f"axes are said to be forward, right, down; {hint}"
    )


def _fastest(rows: ImuRows) -> None:
    rms = float(np.sqrt((rows.rate_rad_s**2).sum(axis=1).mean()))
    if rms > _FASTEST_RAD_S:
        raise InertialError(
            f"{rows.origin}: the gyros, in {rows.gyro_unit.name}, turn by {math.degrees(rms):.0f} "
            f"deg/s all the time; {_gyro_hint(rows, 1 / _DEGREES) or _SCALES}"
        )


def _gyro_hint(rows: ImuRows, factor: float) -> str | None:
    """What the unit is, if values must be multiplied by about a factor."""
    mine = _per_second(rows.gyro_unit, rows.interval_s)
    others = [
        u.name
        for u in GYRO_UNITS
        if 0.5 < _per_second(u, rows.interval_s) / mine / factor < 2.0 and u is not rows.gyro_unit
    ]
    alike = [u.name for u in GYRO_UNITS if u.increment == rows.gyro_unit.increment]
    others = [name for name in others if name in alike] or others
    if not others:
        return None
    return f"the values look like {' or '.join(others)}: name the columns gyro_x_{others[0]}"


def _tilts(rows: ImuRows, up: NDArray[np.float64]) -> bool:
    """Whether tilts could be compared; refuses those that fit a known mistake."""
    felt, turned = _windows(rows)
    if len(felt) < _LEAST_WINDOWS:
        return False
    level = np.linalg.svd(up[None])[2][1:]
    seen = np.diff(felt / np.linalg.norm(felt, axis=1)[:, None], axis=0) @ level.T
    told = np.cross(up, np.diff(turned, axis=0)) @ level.T
    told -= told.mean(axis=0)
    strong, weak = np.linalg.svd(told, compute_uv=False)
    if np.sqrt((seen**2).mean()) < _TILT_RAD or weak <= _BOTH * strong:
        return False
    gain = np.linalg.lstsq(told, seen, rcond=None)[0].T
    fit = 1 - ((seen - told @ gain.T) ** 2).sum() / (seen**2).sum()
    return fit >= _SURE and _judge_gain(rows, gain)


def _judge_gain(rows: ImuRows, gain: NDArray[np.float64]) -> bool:
    """Whether a matrix, from what gyros say of tilts to what accelerometers say, tells something.

    A car that leans outwards has a gain of about -11, which is neither one nor a known mistake.
    """
    size = math.sqrt(abs(np.linalg.det(gain)))
    said = f"{rows.origin}: gyros and accelerometers contradict each other"
    straight = np.abs(gain / size - np.eye(2)).max() < _ALIKE
    hint = _gyro_hint(rows, size)
    if not _SAME[0] < size < _SAME[1]:
        if straight and hint is not None:
            raise InertialError(f"{said} by a factor of {size:.3g}; {hint}")
        return False
    if straight:
        return True
    if np.linalg.det(gain) < 0:
        raise InertialError(
            f"{said}: two axes of one of them are swapped, or one is reversed; check the columns"
        )
    if np.trace(gain) < -size:
        raise InertialError(
            f"{said} in sign: the axes are left-handed, or the gyros turn the other way; check "
            "the columns and axes"
        )
    if np.trace(gain) < size:
        raise InertialError(f"{said}: their x and y axes differ; check the columns and axes")
    return False


def _turns(rows: ImuRows) -> bool:
    """Whether turns could be compared; refuses speeds that no vehicle has."""
    felt, turned = _windows(rows)
    if len(felt) < _LEAST_WINDOWS:
        return False
    rate = np.diff(turned[:, 2]) / (_window(rows) * rows.interval_s)
    side = (felt[1:, 1] + felt[:-1, 1]) / 2
    side = side - side.mean()
    rate = rate - rate.mean()
    if np.sqrt((side**2).mean()) < _SIDE_M_S2 or not rate.any():
        return False
    speed = float(rate @ side / (rate @ rate))
    fit = 1 - ((side - speed * rate) ** 2).sum() / (side**2).sum()
    if fit < _SURE:
        return False
    low, high = _SPEEDS_M_S
    if not low < abs(speed) < high:
        hint = _gyro_hint(rows, _DEGREES if abs(speed) > high else 1 / _DEGREES)
        raise InertialError(
            f"{rows.origin}: turns are felt as at {abs(speed):.3g} m/s; {hint or _SCALES}"
        )
    return True


def _windows(rows: ImuRows) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Means over windows of specific force, and of the angle turned so far, (W, 3) each."""
    count = _window(rows)
    whole = rows.time_s.size // count * count
    angle = np.cumsum(rows.rate_rad_s * rows.interval_s, axis=0)
    means = [v[:whole].reshape(-1, count, 3).mean(axis=1) for v in (rows.force_m_s2, angle)]
    return means[0], means[1]


def _window(rows: ImuRows) -> int:
    """Rows of a window."""
    return max(1, round(_WINDOW_S / rows.interval_s))
