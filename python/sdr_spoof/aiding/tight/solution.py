"""What the tightly coupled filter is given to start with, and what it says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.geodesy import ecef_to_geodetic

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime

    Floats = NDArray[np.float64]

STATES = ("starting", "trusted", "deciding", "partial", "coasting")
"""Of the guard, by number; see docs/design.md."""
USAGES = ("missing", "used", "weakened", "excluded")
"""Of a satellite at an epoch, by number."""
THREATS = ("none", "at risk", "attacked")
"""Verdict of the publication, by number."""
FORMS = ("mean-square", "lag-1", "coherent")
RATE_WINDOWS_S = (1, 3, 7, 14, 25, 50, 100)
SPANS_S = (15, 30, 60, 150)
TESTS = (
    *(f"rates, {s} s" for s in RATE_WINDOWS_S),
    *(f"phase changes, {s} s" for s in RATE_WINDOWS_S),
    *(f"codes, {s} s" for s in (1, 10, 30, 100)),
    *(f"separation, {s} to {2 * s} s" for s in SPANS_S),
    *(f"clock separation, {s} to {2 * s} s" for s in SPANS_S),
    "power",
)
"""Every test, in the order of the columns of ``deviates``."""
JUMP_M = 15.0
"""An alarm of all satellites with the fix so far from the INS may be the end of an attack."""


@dataclass(frozen=True)
class Start:
    """Where the INS is at the start; how well it is known is in the configuration."""

    time_s: float
    position_m: tuple[float, float, float]
    """Earth-fixed."""
    velocity_m_s: tuple[float, float, float]
    """Earth-fixed."""
    attitude_rad: tuple[float, float, float]
    """Yaw, pitch, roll."""


@dataclass(frozen=True)
class Event:
    """Something that the guard did."""

    time_s: float
    state: str
    """That it led to, one of :data:`STATES`."""
    test: str
    """That alarmed; empty where none did."""
    deviate: float
    excluded: tuple[str, ...]
    """Satellites left out from now on."""
    back_s: float
    """Age of the trusted copy that it went back to; 0: it did not."""
    apart_m: float
    """Distance of the fix of all satellites from the INS; NaN without a fix."""

    def words(self) -> str:
        """For the user."""
        if self.test:
            text = f"{self.test} beyond the threshold ({self.deviate:.1f}); back to what was "
            text += f"trusted {self.back_s:.0f} s ago, without GNSS"
            if self.apart_m > JUMP_M:
                text += (
                    f". The fix stands {self.apart_m:.0f} m from the INS at once: an attack begins "
                    "with a jump, or a capture too slow to be seen has ended. No rule tells them "
                    "apart; look at the position before the alarm"
                )
            return text
        if self.state == "partial":
            return f"left out: {', '.join(self.excluded)}; all others agree"
        if self.state == "coasting":
            return "no small set explains it: all satellites are left out, the INS goes on alone"
        return "all satellites agree with the INS again and are used"


@dataclass(frozen=True)
class Smoothed:
    """E epochs, each from all measurements, those after it as well; NaN where not valid.

    Where the guard has gone back to a trusted copy, what was measured since then counts for
    nothing: the way leads from that copy to the first measurements after the coasting.
    """

    position_m: Floats
    """Earth-fixed, of the INS, (E, 3)."""
    velocity_ned_m_s: Floats
    """North, east, down (E, 3)."""
    attitude_rad: Floats
    """Yaw, pitch, roll (E, 3)."""
    covariance: Floats
    """Of position, velocity and attitude, north, east, down (E, 3, 3, 3)."""


@dataclass(frozen=True)
class TightSolution:
    """E epochs of S satellites; arrays (E, S, ...) have S = 0 where details were not asked for."""

    reference: GnssTime | None
    time_s: Floats
    satellites: tuple[str, ...]
    valid: NDArray[np.bool_]
    """Whether there were increments to navigate with, (E,); all else is NaN or 0 where not."""
    position_m: Floats
    """Earth-fixed, of the INS, (E, 3)."""
    velocity_ned_m_s: Floats
    """North, east, down (E, 3)."""
    attitude_rad: Floats
    """Yaw, pitch, roll (E, 3)."""
    covariance: Floats
    """Of position, velocity and attitude, north, east, down (E, 3, 3, 3)."""
    clock_m: Floats
    """(E,)"""
    drift_m_s: Floats
    """(E,)"""
    gyro_bias_rad_s: Floats
    """(E, 3)"""
    accelerometer_bias_m_s2: Floats
    """(E, 3)"""
    range_innovation_m: Floats
    """Predicted minus measured pseudorange (E, S)."""
    range_sigma_m: Floats
    rate_innovation_m_s: Floats
    rate_sigma_m_s: Floats
    usage: NDArray[np.uint8]
    """What each satellite was used for, see :data:`USAGES`, (E, S)."""
    solution_statistic: Floats
    """Published statistics of position (m^2) and velocity, undivided, by form (E, 2, 3)."""
    channel_statistic: Floats
    """Of pseudorange and rate of each satellite (E, S, 2, 3)."""
    threat: NDArray[np.uint8]
    """Verdict of the publication, see :data:`THREATS`, (E,)."""
    severity: Floats
    """Share of the published statistics that are over 1, (E,)."""
    deviates: Floats
    """Every test as a normal deviate (power in dB), see :data:`TESTS`, (E, T)."""
    state: NDArray[np.uint8]
    """Of the guard, see :data:`STATES`, (E,)."""
    events: tuple[Event, ...]
    smoothed: Smoothed | None = None
    """None unless it was asked for."""
    apart_m: Floats | None = None
    """Of the filter without each satellite: its distance from the whole one and its standard
    deviation, horizontally, in the worst direction, and vertically (E, S, 4); NaN where the
    satellite has not been used. None unless it was asked for."""

    @property
    def horizontal_sigma_m(self) -> Floats:
        """Root of the sum of both horizontal variances of position, (E,)."""
        return np.sqrt(self.covariance[:, 0, 0, 0] + self.covariance[:, 0, 1, 1])

    @property
    def first_alarm_s(self) -> float:
        """Time of the first alarm of the guard; NaN without one."""
        return next((e.time_s for e in self.events if e.test), float("nan"))

    def flagged(self, config_divisors: tuple[float, ...], form: str) -> NDArray[np.bool_]:
        """Satellites whose published statistics are over 1 (E, S): the log of PRNs."""
        values = self.channel_statistic[..., FORMS.index(form)]
        with np.errstate(invalid="ignore"):
            return np.asarray((values > np.array(config_divisors[2:])).any(axis=-1))

    def error_ned_m(self, true_m: Floats) -> Floats:
        """Position minus the truth, north, east, down (E, 3)."""
        return local(self.position_m - true_m, true_m)

    def words(self) -> list[str]:
        """What happened, a sentence an event, and what cannot be seen."""
        said = [f"{e.time_s:.0f} s: {e.words()}." for e in self.events]
        said.append(FLOOR)
        return said


FLOOR = (
    "A drag of all satellites below about 0.001 to 0.002 m/s^2 cannot be told from the errors of "
    "an INS of 0.1 deg/h and 50 ug (below about 0.02 m/s^2 for 1 deg/h and 300 ug); after such a "
    "capture its end looks like the onset of an attack."
)


def local(vectors: Floats, at_m: Floats) -> Floats:
    """Earth-fixed vectors (E, 3) as north, east, down at places (E, 3)."""
    latitude, longitude = np.radians(ecef_to_geodetic(at_m)[:, :2]).T
    (sb, sl), (cb, cl) = np.sin([latitude, longitude]), np.cos([latitude, longitude])
    x, y, z = vectors.T
    level = cl * x + sl * y
    return np.stack([cb * z - sb * level, cl * y - sl * x, -cb * level - sb * z], axis=-1)
