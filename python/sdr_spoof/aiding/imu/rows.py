"""What a file of an IMU holds, before it is judged."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..records import ImuLog

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime

STANDARD_G_M_S2 = 9.80665


@dataclass(frozen=True)
class Unit:
    """Of a column."""

    name: str
    """As in the names of columns: ``deg_s``."""
    size: float
    """In rad/s, rad, m/s^2 or m/s."""
    increment: bool
    """Summed up over an interval, rather than a rate."""


GYRO_UNITS = (
    Unit("rad_s", 1.0, increment=False),
    Unit("deg_s", math.radians(1.0), increment=False),
    Unit("rad", 1.0, increment=True),
    Unit("deg", math.radians(1.0), increment=True),
)
ACCEL_UNITS = (
    Unit("m_s2", 1.0, increment=False),
    Unit("g", STANDARD_G_M_S2, increment=False),
    Unit("mg", 1e-3 * STANDARD_G_M_S2, increment=False),
    Unit("m_s", 1.0, increment=True),
    Unit("g_s", STANDARD_G_M_S2, increment=True),
)


@dataclass(frozen=True)
class ImuRows:
    """N rows of a file, in SI units and, until they are turned, in the IMU's own axes."""

    origin: str
    """The file, for messages."""
    reference: GnssTime | None
    """What ``time_s`` counts from."""
    time_s: NDArray[np.float64]
    """Instant of a rate, end of the interval of an increment, (N,)."""
    gyro: NDArray[np.float64]
    """rad/s or rad, (N, 3)."""
    accel: NDArray[np.float64]
    """m/s^2 or m/s, (N, 3)."""
    gyro_unit: Unit
    """As the file says, or as its format has it."""
    accel_unit: Unit
    lever_arm_m: tuple[float, float, float] | None = None
    """Antenna from the IMU, forward, right, down, where the file tells."""

    @property
    def interval_s(self) -> float:
        """Usual time between rows; 0 where there are less than two."""
        return float(np.median(np.diff(self.time_s))) if self.time_s.size > 1 else 0.0

    @property
    def rate_rad_s(self) -> NDArray[np.float64]:
        """Angular rate of each row, (N, 3)."""
        return self.gyro / self.interval_s if self.gyro_unit.increment else self.gyro

    @property
    def force_m_s2(self) -> NDArray[np.float64]:
        """Specific force of each row, (N, 3)."""
        return self.accel / self.interval_s if self.accel_unit.increment else self.accel

    def increments(self) -> ImuLog:
        """Increments; of rates, the integrals between neighbours under cubics through four rows.

        The first row after a gap has the nominal interval at its own rate. Where rows are late or
        early by less than half an interval their spacing is taken to be even.
        """
        step = self.interval_s
        starts = np.concatenate([[True], np.diff(self.time_s) > 1.5 * step])
        rotation = self.gyro if self.gyro_unit.increment else step * _means(self.gyro, starts)
        velocity = self.accel if self.accel_unit.increment else step * _means(self.accel, starts)
        return ImuLog(self.reference, self.time_s, step, rotation, velocity)


def _means(rates: NDArray[np.float64], starts: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Mean of each row's interval, back to the row before, (N, 3); ``starts`` follow gaps."""
    means = rates.copy()
    means[1:] = (rates[1:] + rates[:-1]) / 2
    inner = ~(starts[1:-2] | starts[2:-1] | starts[3:]) if len(rates) > 3 else np.zeros(0, bool)
    k = np.flatnonzero(inner) + 2
    means[k] = (13 * (rates[k - 1] + rates[k]) - rates[k - 2] - rates[k + 1]) / 24
    means[starts] = rates[starts]
    return means
