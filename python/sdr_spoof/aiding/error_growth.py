"""How uncertain an INS is, by the time since its alignment, for a quality of IMU.

The phi-angle model of ``rust/core/src/inertial/error_model.rs`` along the motion: biases (constant
and wandering), white noise, and what the alignment left. Scale factors and misalignments of the
sensors are not in it: they are errors of motion rather than of time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core

from .navigation_plan import plan

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .imu.grades import Grade, SensorGrade
    from .records import ImuLog, InertialStates

Three = tuple[float, float, float]


@dataclass(frozen=True)
class AlignmentSigma:
    """Standard deviations right after an alignment, about north, east, down; default: perfect."""

    position_m: Three = (0.0, 0.0, 0.0)
    velocity_m_s: Three = (0.0, 0.0, 0.0)
    attitude_rad: Three = (0.0, 0.0, 0.0)
    """About north and east: level; about down: heading."""


@dataclass(frozen=True)
class ErrorGrowth:
    """Covariance of the errors of an INS at M times, in local axes (north, east, down)."""

    time_s: NDArray[np.float64]
    """(M,)"""
    covariance: NDArray[np.float64]
    """Position (m), velocity (m/s), attitude (phi, rad), (M, 9, 9)."""

    def sigma(self) -> NDArray[np.float64]:
        """Standard deviations (M, 9)."""
        variance = np.einsum("mii->mi", self.covariance)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    @property
    def position_sigma_m(self) -> NDArray[np.float64]:
        """North, east, down, (M, 3)."""
        return self.sigma()[:, :3]

    @property
    def velocity_sigma_m_s(self) -> NDArray[np.float64]:
        """North, east, down, (M, 3)."""
        return self.sigma()[:, 3:6]

    @property
    def velocity_covariance(self) -> NDArray[np.float64]:
        """Of the velocity alone, (m/s)^2, (M, 3, 3)."""
        return self.covariance[:, 3:6, 3:6]


def error_growth(
    ideal: ImuLog,
    start: InertialStates,
    grade: Grade,
    *,
    every: int,
    alignment: AlignmentSigma | None = None,
) -> ErrorGrowth:
    """Covariance of an INS that is aligned at ``start`` and then left alone.

    Args:
        ideal: Increments along the motion, of an IMU good enough for the motion to be known;
            ``increments.at_rest`` where the motion does not matter.
        start: State at the alignment, one row, where the increments begin.
        grade: Quality of the IMU (``imu.grades.named``); a bias of fixed size and random sign
            counts with its size.
        every: A row of output each so many increments.
        alignment: What is uncertain at the start.

    Raises:
        InertialError: as :func:`strapdown.navigate`.
    """
    planned = plan(ideal, start, every=every)
    sigma = alignment or AlignmentSigma()
    covariance = _core.inertial_covariance(
        *planned.arrays(),
        every=every,
        gyro=_noise(grade.gyro),
        accelerometer=_noise(grade.accelerometer),
        alignment=(sigma.position_m, sigma.velocity_m_s, sigma.attitude_rad),
    )
    return ErrorGrowth(planned.output_s(), covariance)


def _noise(grade: SensorGrade) -> list[float]:
    return [grade.bias, grade.wander, grade.wander_s, grade.density]
