"""What positioning finds: columns of epochs, and what was left out of them and why."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from .signals import LIGHT_M_S

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .nav.time import GnssTime
    from .observations import ObservedSignal

DOP_NAMES = ("GDOP", "PDOP", "HDOP", "VDOP", "TDOP")


class Status(IntEnum):
    """How far a fix is to be trusted."""

    NO_FIX = 0
    """There is none; :meth:`Fixes.reason` says why."""
    FIX = 1
    """The residuals are as noise makes them."""
    SUSPECT = 2
    """They are not, and leaving satellites out does not explain it: do not trust the position."""
    UNCHECKED = 3
    """Nothing would show if it were wrong: there was no satellite more than needed, or time and
    orbits come from the user alone, so that a sky turned as a whole would agree with itself."""


class Cause(IntEnum):
    """Why a signal is in a fix or is not."""

    USED = 0
    NOT_OBSERVED = 1
    NOT_WANTED = 2
    """The configuration names other signals."""
    SPOOFED = 3
    """The detectors say so."""
    NO_EPHEMERIS = 4
    STALE = 5
    """The ephemeris is older, or younger, than it is good for."""
    UNHEALTHY = 6
    WEAK = 7
    """Less C/N0 than asked for."""
    LOW = 8
    """Below the elevation mask."""
    RESIDUAL = 9
    """RAIM: it does not agree with the others."""
    NO_FIX = 10
    """There is no position at that epoch."""
    SUSPECT = 11
    """Under suspicion while the detectors call another satellite spoofed."""


CAUSES = {
    Cause.NOT_WANTED: "signal not configured",
    Cause.SPOOFED: "spoofed",
    Cause.NO_EPHEMERIS: "no ephemeris",
    Cause.STALE: "stale ephemeris",
    Cause.UNHEALTHY: "unhealthy",
    Cause.WEAK: "weak",
    Cause.LOW: "below the elevation mask",
    Cause.RESIDUAL: "excluded by RAIM",
    Cause.NO_FIX: "no position to use it for",
    Cause.SUSPECT: "under suspicion while others are spoofed",
}
"""In words."""

TOO_FEW, BAD_GEOMETRY, DIVERGED = 1, 2, 3
FAILURES = {
    TOO_FEW: "too few satellites",
    BAD_GEOMETRY: "the satellites stand too badly for a position",
    DIVERGED: "no position fits the pseudoranges",
}
"""Why there is no fix, in words."""


@dataclass(frozen=True)
class Exclusion:
    """A signal that was left out of some epochs."""

    satellite: str
    """RINEX name."""
    signal: str
    cause: Cause
    epochs: int
    from_s: float
    """Receiver time, as ``Fixes.time_s``."""
    until_s: float

    def __str__(self) -> str:
        """In words."""
        return f"{self.satellite} {self.signal}: {CAUSES[self.cause]}"


@dataclass(frozen=True)
class Fixes:
    """E epochs of S signals and C systems; NaN where there is none.

    Coordinates are Earth-fixed, at the instant of reception.
    """

    reference: GnssTime
    """As of the observations: ``time_s`` counts from it by the receiver's clock."""
    time_s: NDArray[np.float64]
    """(E,)"""
    signals: tuple[ObservedSignal, ...]
    """Columns of ``used`` and others."""
    systems: tuple[str, ...]
    """Columns of ``clock_m``."""
    status: NDArray[np.uint8]
    """(E,), values of :class:`Status`."""
    failure: NDArray[np.uint8]
    """(E,), keys of :data:`FAILURES`; 0 where there is a fix."""
    position_m: NDArray[np.float64]
    """(E, 3)"""
    velocity_m_s: NDArray[np.float64]
    """(E, 3)"""
    clock_m: NDArray[np.float64]
    """(E, C): receiver clock minus system time, times the speed of light; the difference of two
    is the offset between systems, delays of the receiver included."""
    drift_m_s: NDArray[np.float64]
    """(E,): rate of the receiver's clock."""
    biases: tuple[str, ...]
    """Columns of ``bias_m``: system and signal, such as C B1CP."""
    bias_m: NDArray[np.float64]
    """(E, B): delay of a signal in the receiver against the first signal of its system."""
    covariance_m2: NDArray[np.float64]
    """(E, 3, 3), of the position, by the assumed noise."""
    velocity_covariance: NDArray[np.float64]
    """(E, 3, 3), m^2/s^2."""
    dop: NDArray[np.float64]
    """(E, 5): :data:`DOP_NAMES`."""
    cause: NDArray[np.uint8]
    """(E, S), values of :class:`Cause`."""
    residual_m: NDArray[np.float64]
    """(E, S): measured minus modelled, of what is used."""
    azimuth_deg: NDArray[np.float64]
    """(E, S): of every signal with an ephemeris."""
    elevation_deg: NDArray[np.float64]
    """(E, S)"""
    square_sum: NDArray[np.float64]
    """(E,): weighted sum of squared residuals, chi-square under H0 (least squares only)."""
    freedom: NDArray[np.int64]
    """(E,): its degrees of freedom."""
    usable: NDArray[np.int64]
    """(E,): satellites that could be used before mask and RAIM."""

    @property
    def epochs(self) -> int:
        """Number of epochs."""
        return len(self.time_s)

    @property
    def used(self) -> NDArray[np.bool_]:
        """(E, S): whether the fix rests on a signal."""
        return np.asarray(self.cause == Cause.USED)

    @property
    def fixed(self) -> NDArray[np.bool_]:
        """(E,): whether there is a position, whatever is to be thought of it."""
        return np.asarray(self.status != Status.NO_FIX)

    @property
    def clock_s(self) -> NDArray[np.float64]:
        """(E,): receiver clock minus the time of the first system that has one."""
        if not self.systems:
            return np.full(self.epochs, np.nan)
        first = np.argmax(np.isfinite(self.clock_m), axis=1)
        return np.asarray(self.clock_m[np.arange(self.epochs), first] / LIGHT_M_S)

    def time(self, epoch: int) -> GnssTime:
        """Receiver time of an epoch, less the clock's offset where there is a fix."""
        offset = float(np.nan_to_num(self.clock_s[epoch]))
        return self.reference + (float(self.time_s[epoch]) - offset)

    def reason(self, epoch: int) -> str:
        """Why there is no fix at an epoch; empty where there is one."""
        code = int(self.failure[epoch])
        if code == 0:
            return ""
        if code == TOO_FEW:
            return f"{FAILURES[code]}: {self.usable[epoch]} usable before the elevation mask"
        return FAILURES[code]

    @property
    def excluded(self) -> tuple[Exclusion, ...]:
        """Signals that were observed but left out, by cause, in order of signals."""
        found = []
        for column, signal in enumerate(self.signals):
            for cause in CAUSES:
                rows = np.flatnonzero(self.cause[:, column] == cause)
                if rows.size:
                    first, last = self.time_s[rows[[0, -1]]]
                    name = signal.satellite
                    found.append(
                        Exclusion(name, signal.signal, cause, rows.size, float(first), float(last))
                    )
        return tuple(found)

    def spoofed(self, epoch: int) -> tuple[str, ...]:
        """Satellites left out of an epoch as spoofed."""
        columns = np.flatnonzero(self.cause[epoch] == Cause.SPOOFED)
        return tuple(dict.fromkeys(self.signals[c].satellite for c in columns))
