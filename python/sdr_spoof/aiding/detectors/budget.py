"""How large the errors of an INS are: of its sensors by their grade, and after alignment."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.aiding.imu import grades

if TYPE_CHECKING:
    from sdr_spoof.aiding.imu.grades import SensorGrade
    from sdr_spoof.aiding.rate_config import RateConfig

WANDER_S = 1000.0
"""Time over which ``bias_wander`` is stated."""


@dataclass(frozen=True)
class Budget:
    """Standard deviations, SI units."""

    gyro_bias: float
    gyro_density: float
    """Angle random walk, rad/sqrt(s)."""
    gyro_walk: float
    """Growth of the variance of a bias, (rad/s)^2/s."""
    gyro_scale: float
    """Scale factor and misalignment together."""
    accelerometer_bias: float
    accelerometer_density: float
    accelerometer_walk: float
    accelerometer_scale: float
    position_m: float
    """This and the next ones: what alignment leaves."""
    velocity_m_s: float
    level_rad: float
    heading_rad: float


def of(config: RateConfig) -> Budget:
    """Of the configured grade and alignment.

    Raises:
        ConfigError: there is no such grade.
    """
    grade = grades.named(config.grade)
    return Budget(
        *_sensors(grade.gyro, config.bias_wander, 0.0),
        *_sensors(grade.accelerometer, config.bias_wander, grades.GRAVITY_M_S2),
        config.align_position_m,
        config.align_velocity_m_s,
        math.radians(config.align_level_deg),
        math.radians(config.align_heading_deg),
    )


def _sensors(grade: SensorGrade, wander: float, steady: float) -> tuple[float, float, float, float]:
    """Bias, density, walk, scale; what scale errors make of a ``steady`` input is a bias."""
    scale = math.hypot(grade.scale, grade.misalignment_rad)
    bias = math.hypot(grade.bias, grade.wander)
    walk = 2 * grade.wander**2 / grade.wander_s + (wander * bias) ** 2 / WANDER_S
    return math.hypot(bias, scale * steady), grade.density, walk, scale
