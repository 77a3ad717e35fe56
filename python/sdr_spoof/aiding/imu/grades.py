"""Qualities of IMUs by name, and draws of the errors of single ones.

Values are standard deviations over the sensors of a kind, except where ``law`` is ``sign``: there
each sensor's bias has that size, and a random sign. The correlation times of wandering biases are
not in data sheets and assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from sdr_spoof.errors import ConfigError

from .errors import ImuErrors, SensorErrors

if TYPE_CHECKING:
    from numpy.typing import NDArray

GRAVITY_M_S2 = 9.80665
"""The g of data sheets."""
DEG_S = math.radians(1.0)
DEG_HOUR = DEG_S / 3600
"""1 deg/h in rad/s."""
DEG_ROOT_HOUR = DEG_S / 60
"""1 deg/sqrt(h) in rad/sqrt(s)."""
MICRO_G = 1e-6 * GRAVITY_M_S2
"""1 ug in m/s^2; 1 ug/sqrt(Hz) is as many m/s/sqrt(s)."""
PPM = 1e-6


@dataclass(frozen=True)
class SensorGrade:
    """Three gyros or three accelerometers; u is rad/s or m/s^2."""

    bias: float
    """What is left after calibration, constant in a run, u."""
    density: float = 0.0
    """Random walk, u sqrt(s)."""
    wander: float = 0.0
    """Gauss-Markov bias (bias instability), u."""
    wander_s: float = math.inf
    scale: float = 0.0
    """Relative."""
    misalignment_rad: float = 0.0
    limit: float = math.inf
    """Range, u."""


@dataclass(frozen=True)
class Grade:
    """A quality of IMUs."""

    name: str
    title: str
    """In words, with the source of the numbers."""
    gyro: SensorGrade
    accelerometer: SensorGrade
    law: Literal["normal", "sign"] = "normal"
    """Of the constant biases."""


_BRIEF = (
    Grade(
        "navigation",
        "ring laser gyros; Honeywell HG9900, product brochure N61-1638; velocity random walk and "
        "misalignment assumed, of the order of aviation grade in Groves 2013, section 4.4",
        SensorGrade(0.0035 * DEG_HOUR, 0.002 * DEG_ROOT_HOUR, scale=5 * PPM, misalignment_rad=1e-5),
        SensorGrade(25 * MICRO_G, 20 * MICRO_G, scale=100 * PPM, misalignment_rad=1e-5),
    ),
    Grade(
        "tactical",
        "Honeywell HG1700, product brochure N61-1619 (0.065 ft/s/sqrt(h)); scale factors, "
        "misalignments assumed, of the order of tactical grade in Groves 2013, section 4.4",
        SensorGrade(
            1.0 * DEG_HOUR,
            0.125 * DEG_ROOT_HOUR,
            scale=300 * PPM,
            misalignment_rad=300e-6,
            limit=1000 * DEG_S,
        ),
        SensorGrade(
            1000 * MICRO_G,
            0.065 * 0.3048 / 60,
            scale=300 * PPM,
            misalignment_rad=300e-6,
            limit=50 * GRAVITY_M_S2,
        ),
    ),
    Grade(
        "industrial",
        "calibrated MEMS; Analog Devices ADIS16488A, data sheet, table 1 (in-run stability, random "
        "walks, misalignment, range); constant bias and scale factor: as after calibration on a "
        "bench, assumed",
        SensorGrade(
            20 * DEG_HOUR,
            0.26 * DEG_ROOT_HOUR,
            5.1 * DEG_HOUR,
            1000.0,
            scale=1000 * PPM,
            misalignment_rad=0.05 * DEG_S,
            limit=450 * DEG_S,
        ),
        SensorGrade(
            1000 * MICRO_G,
            0.029 / 60,
            70 * MICRO_G,
            1000.0,
            scale=1000 * PPM,
            misalignment_rad=0.035 * DEG_S,
            limit=18 * GRAVITY_M_S2,
        ),
    ),
    Grade(
        "mems",
        "surface-mounted MEMS; Xsens MTi-1, data sheet (instability, noise density, range); "
        "constant bias, scale factor and misalignment: as after standing still, assumed",
        SensorGrade(
            100 * DEG_HOUR,
            0.007 * DEG_S,
            10 * DEG_HOUR,
            1000.0,
            scale=5000 * PPM,
            misalignment_rad=0.05 * DEG_S,
            limit=2000 * DEG_S,
        ),
        SensorGrade(
            5000 * MICRO_G,
            120 * MICRO_G,
            30 * MICRO_G,
            1000.0,
            scale=5000 * PPM,
            misalignment_rad=0.05 * DEG_S,
            limit=16 * GRAVITY_M_S2,
        ),
    ),
    Grade(
        "n1",
        "published INS N1 of pseudorange-rate consistency: 0.1 deg/h, 10 ug, no noise",
        SensorGrade(0.1 * DEG_HOUR),
        SensorGrade(10 * MICRO_G),
        "sign",
    ),
    Grade(
        "n2",
        "published INS N2 of pseudorange-rate consistency: 0.5 deg/h, 50 ug, no noise",
        SensorGrade(0.5 * DEG_HOUR),
        SensorGrade(50 * MICRO_G),
        "sign",
    ),
    Grade(
        "ship-a",
        "better INS of the study of ship-borne coupling: 0.1 deg/h, 50 ug, 0.01 deg/sqrt(h), "
        "10 ug/sqrt(Hz)",
        SensorGrade(0.1 * DEG_HOUR, 0.01 * DEG_ROOT_HOUR),
        SensorGrade(50 * MICRO_G, 10 * MICRO_G),
        "sign",
    ),
    Grade(
        "ship-b",
        "worse INS of the study of ship-borne coupling: 1 deg/h, 300 ug, 0.1 deg/sqrt(h), "
        "50 ug/sqrt(Hz)",
        SensorGrade(1.0 * DEG_HOUR, 0.1 * DEG_ROOT_HOUR),
        SensorGrade(300 * MICRO_G, 50 * MICRO_G),
        "sign",
    ),
)
GRADES = {grade.name: grade for grade in _BRIEF}
"""Groves 2013: Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd
edition, Artech House."""


def named(name: str) -> Grade:
    """A grade by its name.

    Raises:
        ConfigError: there is none.
    """
    if name not in GRADES:
        raise ConfigError(f"no IMU grade '{name}'; there are: {', '.join(GRADES)}")
    return GRADES[name]


def draw(grade: Grade | str, seed: int, runs: int = 1) -> list[ImuErrors]:
    """Errors of IMUs of a grade, one for each run; run k does not depend on how many there are."""
    one = named(grade) if isinstance(grade, str) else grade
    return [one_run(one, seed, run) for run in range(runs)]


def one_run(grade: Grade, seed: int, run: int) -> ImuErrors:
    """Errors of the IMU of one run."""
    rng = np.random.default_rng([seed, run])
    gyro = _sensors(grade.gyro, grade.law, rng)
    accelerometer = _sensors(grade.accelerometer, grade.law, rng)
    return ImuErrors(gyro, accelerometer, seed, run)


def _sensors(grade: SensorGrade, law: str, rng: np.random.Generator) -> SensorErrors:
    # All are drawn always, so that grades of one seed differ in size only.
    signs, normal = rng.choice([-1.0, 1.0], 3), rng.standard_normal((4, 3))
    return SensorErrors(
        bias=_three(grade.bias * (signs if law == "sign" else normal[0])),
        wander=grade.wander,
        wander_s=grade.wander_s,
        density=grade.density,
        scale=_three(grade.scale * normal[1]),
        misalignment_rad=(
            *_three(grade.misalignment_rad * normal[2]),
            *_three(grade.misalignment_rad * normal[3]),
        ),
        limit=grade.limit,
    )


def _three(values: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z
