"""Records of aided navigation: what an IMU senses, what an INS makes of it, what GNSS measures.

Body axes are forward, right, down; attitudes are yaw (from north to east), pitch and roll against
north, east, down; coordinates are Earth-fixed. Times are seconds of system time since a reference
that is the same for all records that go together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime


@dataclass(frozen=True)
class ImuLog:
    """N increments of one IMU."""

    reference: GnssTime | None
    """Instant that ``time_s`` counts from; None where the IMU knows no GNSS time."""
    time_s: NDArray[np.float64]
    """End of each interval, ascending, (N,)."""
    interval_s: float
    """Nominal length of an interval: the reciprocal of the rate."""
    rotation_rad: NDArray[np.float64]
    """Angle that each gyro has summed up over the interval, against inertial space, (N, 3)."""
    velocity_m_s: NDArray[np.float64]
    """Specific force that each accelerometer has summed up over the interval, (N, 3)."""

    def part(self, start: int, stop: int) -> Self:
        """Increments ``start`` to ``stop``."""
        names = ("time_s", "rotation_rad", "velocity_m_s")
        return replace(self, **{name: getattr(self, name)[start:stop] for name in names})


@dataclass(frozen=True)
class InertialStates:
    """What an INS says at M times, of its own point (not of the antenna)."""

    reference: GnssTime | None
    time_s: NDArray[np.float64]
    """(M,)"""
    position_m: NDArray[np.float64]
    """(M, 3)"""
    velocity_m_s: NDArray[np.float64]
    """Against the Earth, in Earth-fixed axes, (M, 3)."""
    attitude_rad: NDArray[np.float64]
    """Yaw, pitch, roll (M, 3)."""
    aligned_s: NDArray[np.float64]
    """Seconds since the last alignment, (M,)."""


@dataclass(frozen=True)
class Measurements:
    """E epochs of S satellites, ready for a filter or a test; NaN where there is none.

    One column a satellite (one signal of it). Satellite clocks, group delays and the atmosphere
    are taken off; what is left is geometry, the receiver's clock, and noise.
    """

    reference: GnssTime | None
    time_s: NDArray[np.float64]
    """System time of each epoch since ``reference``, (E,)."""
    satellites: tuple[str, ...]
    """RINEX names of the columns."""
    satellite_m: NDArray[np.float64]
    """Earth-fixed place of the satellite at transmission, in the axes at reception, (E, S, 3)."""
    satellite_velocity_m_s: NDArray[np.float64]
    """Likewise, (E, S, 3)."""
    range_m: NDArray[np.float64]
    """Distance plus the receiver's clock, (E, S). Clocks of systems differ by constants."""
    rate_m_s: NDArray[np.float64]
    """Rate of that distance and clock at the epoch, from Doppler, (E, S)."""
    change_m: NDArray[np.float64]
    """What distance and clock have changed by since the epoch before, from carrier phase; NaN
    where the phase may have slipped, (E, S)."""
    cn0_dbhz: NDArray[np.float64]
    """(E, S)"""
    spoofed: NDArray[np.bool_]
    """Whether the receiver's own detectors call the satellite spoofed, (E, S)."""
    lever_arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Antenna from the INS: forward, right, down."""

    @property
    def systems(self) -> tuple[str, ...]:
        """RINEX system letters of the columns."""
        return tuple(name[0] for name in self.satellites)

    def part(self, start: int, stop: int) -> Self:
        """Epochs ``start`` to ``stop``; the first change keeps what it counts from."""
        names = (
            *("time_s", "satellite_m", "satellite_velocity_m_s", "range_m", "rate_m_s"),
            *("change_m", "cn0_dbhz", "spoofed"),
        )
        return replace(self, **{name: getattr(self, name)[start:stop] for name in names})
