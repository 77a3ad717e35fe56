"""Errors of inertial sensors; the arithmetic, and the definition of each term, are in the core.

In SI units: u is rad/s for a gyro and m/s^2 for an accelerometer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..records import ImuLog

Three = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class SensorErrors:
    """Three gyros or three accelerometers, in body axes; the default is perfect ones."""

    bias: Three = (0.0, 0.0, 0.0)
    """Constant, u."""
    wander: float = 0.0
    """Standard deviation of a first-order Gauss-Markov bias of each axis, u."""
    wander_s: float = math.inf
    """Its correlation time."""
    density: float = 0.0
    """White noise: standard deviation of the sum over 1 s, u sqrt(s): rad/sqrt(s) of a gyro (angle
    random walk), m/s/sqrt(s) of an accelerometer (velocity random walk)."""
    scale: Three = (0.0, 0.0, 0.0)
    """Relative error of each scale factor."""
    misalignment_rad: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """What the x sensor reads of y and of z, y of x and of z, z of x and of y."""
    limit: float = math.inf
    """Largest value that can be read, u."""
    quantum: float = 0.0
    """Step of the sum over an interval, u s; 0: none."""


@dataclass(frozen=True)
class ImuErrors:
    """Errors of one IMU in one run. The noise depends on ``seed``, ``run`` and the row only."""

    gyro: SensorErrors = SensorErrors()
    accelerometer: SensorErrors = SensorErrors()
    seed: int = 0
    run: int = 0
    """Runs of one seed are independent."""


@dataclass(frozen=True)
class Readings:
    """What an IMU reads, and the biases that it had."""

    log: ImuLog
    gyro_bias_rad_s: NDArray[np.float64]
    """Constant and wandering part in each interval, (N, 3)."""
    accelerometer_bias_m_s2: NDArray[np.float64]
    """Likewise, (N, 3)."""


def read(ideal: ImuLog, errors: ImuErrors, *, first: int = 0) -> Readings:
    """What an IMU with these errors reads where a perfect one reads ``ideal``.

    Args:
        ideal: Increments, all of the nominal length.
        errors: What is added.
        first: Number of the first row within the run, for a run in pieces. The pieces have the
            bits of the whole, but for what a quantised sensor carries over.
    """
    rotation, velocity, gyro, accelerometer = _core.imu_readings(
        np.ascontiguousarray(ideal.rotation_rad),
        np.ascontiguousarray(ideal.velocity_m_s),
        ideal.interval_s,
        errors,
        first=first,
    )
    log = replace(ideal, rotation_rad=rotation, velocity_m_s=velocity)
    return Readings(log, gyro, accelerometer)
