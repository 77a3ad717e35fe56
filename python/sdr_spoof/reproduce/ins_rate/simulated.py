"""What the sections share: flights with their drift, and the noise of the receiver."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.imu import grades

from . import drift, published
from .flights import BETWEEN_S, Sampled, flight, sampled

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .drift import Drift

    Floats = NDArray[np.float64]

BIAS_SEED = 1
SKY = (
    (244, 25),
    (224, 40),
    (175, 50),
    (132, 38),
    (114, 23),
    (150, 75),
    (198, 58),
    (20, 72),
    (300, 60),
    (70, 55),
)
"""Azimuth and elevation of ten satellites in degrees: five geostationary ones of BeiDou as 34 N,
108 E sees them, five others high up; chosen so that 0.05 m/s a satellite give 0.054 m/s north, what
the printed threshold means."""
RATE_NOISE_M_S = 0.05
"""Of one satellite, as the study of the publication has it."""
CASES = ("n1", "n2", "accelerometers", "gyros 0.01")
"""INS that are flown: the publication's, one with perfect gyros, one with gyros of 0.01 deg/h."""


@dataclass(frozen=True)
class Fleet:
    """R random flights with the drift of each INS."""

    flights: Sampled
    free: Drift
    """Of ``CASES``, aligned at 0 s only."""
    realigned: Drift
    """Of N1 and N2, aligned each 250 s."""

    def rate(self, case: str) -> Floats:
        """Error of the displacement over each second, east, north, up (R, M, 3), in m/s."""
        return np.asarray(self.free.rate_m_s[CASES.index(case)])

    def position(self, case: str) -> Floats:
        """At the end of each second, (R, M, 3)."""
        return self.free.position_m[CASES.index(case), :, 1:]


def biases(runs: int) -> tuple[Floats, Floats]:
    """Of the gyros and accelerometers of N1 in each run, (R, 3) each."""
    drawn = [grades.one_run(grades.named("n1"), BIAS_SEED, run) for run in range(runs)]
    gyro = np.array([errors.gyro.bias for errors in drawn])
    return gyro, np.array([errors.accelerometer.bias for errors in drawn])


@cache
def fleet(runs: int, between_s: float = BETWEEN_S) -> Fleet:
    """Flights 0 to ``runs`` and their drift."""
    flights = sampled([flight(number, between_s) for number in range(runs)])
    gyro, accelerometer = biases(runs)
    free = drift.grow(
        flights,
        np.stack([gyro, 5 * gyro, 0 * gyro, 0.1 * gyro]),
        np.stack([accelerometer, 5 * accelerometer, accelerometer, accelerometer]),
    )
    again = drift.grow(
        flights,
        np.stack([gyro, 5 * gyro]),
        np.stack([accelerometer, 5 * accelerometer]),
        realign_s=250,
    )
    return Fleet(flights, free, again)


def dilution() -> Floats:
    """Cofactors of east, north, up of a solution with clock, (3, 3)."""
    azimuth, elevation = np.radians(np.array(SKY, float)).T
    level = np.cos(elevation)
    line = np.stack([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)], axis=-1)
    design = np.column_stack([-line, np.ones(len(line))])
    return np.asarray(np.linalg.inv(design.T @ design)[:3, :3])


def white(rng: np.random.Generator, shape: tuple[int, ...], sigma: float) -> Floats:
    """Noise of resolved rates whose satellites have white noise, (..., 3)."""
    root = np.linalg.cholesky(dilution())
    return np.asarray(sigma * rng.standard_normal((*shape, 3)) @ root.T)


def position_noise(rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    """As the printed thresholds of the position form mean it, (..., 2)."""
    return np.asarray(rng.standard_normal((*shape, 2)) * np.array(published.POSITION_SIGMA_M))
