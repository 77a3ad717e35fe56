"""What was measured of every signal at common instants of receiver time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .signals import satellite_name

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .nav.time import GnssTime
    from .observables.clock import ReceiverClock

SUBCARRIER = "B1I+B1C"
"""Name of the pseudorange from the subcarrier of a satellite's B1I and B1C."""


@dataclass(frozen=True, order=True)
class ObservedSignal:
    """A column of the observations."""

    system: str
    """RINEX system letter."""
    prn: int
    signal: str
    """Registry signal, or :data:`SUBCARRIER`."""

    @property
    def satellite(self) -> str:
        """RINEX satellite name, e.g. C23."""
        return satellite_name(self.system, self.prn)


@dataclass(frozen=True)
class Observations:
    """E epochs of S signals, at whole multiples of an interval of receiver time.

    Values are of shape (E, S), NaN where there is none. Signs as in docs/conventions.md.
    """

    reference: GnssTime
    """Receiver time that ``time_s`` counts from: a whole second of GPST, as the receiver's clock
    has it, which is off by what a fix calls the clock's bias."""
    time_s: NDArray[np.float64]
    """Receiver time of each epoch since ``reference``; whole multiples of ``interval_s``."""
    sample_time_s: NDArray[np.float64]
    """The same instants by the samples: s since the first sample of the recording."""
    interval_s: float
    signals: tuple[ObservedSignal, ...]
    """Columns, in order of system, PRN and signal."""
    pseudorange_m: NDArray[np.float64]
    """Speed of light times (receiver time - transmit time by the satellite's clock). That of
    :data:`SUBCARRIER` may miss whole multiples of its ambiguity: c / (f_u - f_l), or half of that
    where ``half_cycle``; it has neither phase nor Doppler, and the C/N0 of the phase difference."""
    carrier_phase_cycles: NDArray[np.float64]
    """Grows as the range grows, begins near the pseudorange. An unknown number of whole cycles
    (half ones where ``half_cycle``) is constant from one ``lock_lost`` to the next."""
    doppler_hz: NDArray[np.float64]
    cn0_dbhz: NDArray[np.float64]
    lock_lost: NDArray[np.bool_]
    """Whether the carrier phase may have slipped or begun anew since the signal's last epoch."""
    half_cycle: NDArray[np.bool_]
    """Whether the carrier phase may be off by half a cycle."""
    spoofed: NDArray[np.bool_]
    """Whether the satellite is spoofed at that epoch, by the detectors."""
    clock: ReceiverClock | None = None
    """What receiver time went by."""
    unsettled_m: NDArray[np.float64] | None = None
    """Standard deviation of what each pseudorange may be off beyond the noise of a settled code
    loop: after a lock, and where a jump shows that it follows. None where nothing is known."""
    notes: tuple[str, ...] = ()
    """What could not be observed, and why, a sentence each."""

    @property
    def epochs(self) -> int:
        """Number of epochs."""
        return len(self.time_s)

    def time(self, epoch: int) -> GnssTime:
        """Receiver time of an epoch."""
        return self.reference + float(self.time_s[epoch])

    @property
    def satellites(self) -> tuple[str, ...]:
        """RINEX names of the satellites observed, in order."""
        return tuple(dict.fromkeys(s.satellite for s in self.signals))

    def columns(self, signal: str) -> NDArray[np.intp]:
        """Columns of one kind of signal."""
        return np.flatnonzero([s.signal == signal for s in self.signals])
