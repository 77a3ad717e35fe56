"""Frozen records passed from stage to stage; nobody mutates another stage's record.

Conventions (docs/conventions.md): times are seconds since the first sample of the recording,
carrier phase grows as range grows (RINEX sense), Doppler is positive when approaching.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from .gain import GainLog
    from .gaps import CountBreak


@dataclass(frozen=True)
class Acquisition:
    """One signal of one satellite, as the FFT search saw it."""

    signal: str
    prn: int
    detected: bool
    sample_index: int
    """Sample at which delay and Doppler hold."""
    doppler_hz: float
    code_delay_s: float
    """From that sample to the first following start of a code period, in [0, period)."""
    cn0_dbhz: float
    statistic: float
    threshold: float
    doppler_bin_hz: float


class State(IntEnum):
    """State of a tracked sideband, in order of progress."""

    LOST = 0
    PULL_IN = 1
    """1 ms integrations: frequency from blocks of prompts, then the phase loop."""
    TRACKING = 2
    """Phase and code locked; secondary code or bit edges not yet known."""
    SYNCED = 3
    """Secondary code or bit edges known; long integrations."""
    COMBO = 4
    """Tracked jointly with the other sideband of the satellite."""
    CAPTURED = 5
    """As SYNCED, but marked as captured by a spoofer; of a pair: one of its sidebands is."""


PART_EPOCHS = 1 << 15
"""Epochs worked on at a time where a whole track would be too much: 4 MB of a signal's rows."""


@dataclass(frozen=True)
class Track:
    """What the tracks have in common: columns of N rows, one row per epoch, times mid-epoch.

    A track whose rows are on disk (:mod:`sdr_spoof.row_store`) reads a column each time that it is
    asked for it: take it once, or :meth:`in_memory` where most are needed.
    """

    NOT_COLUMNS: ClassVar[frozenset[str]] = frozenset()
    """Fields that do not have one value per epoch."""

    if TYPE_CHECKING:
        time_s: NDArray[np.float64]
        integration_s: NDArray[np.float64]

    @classmethod
    def columns(cls) -> list[str]:
        """Names of the fields that have one row per epoch."""
        return [f.name for f in fields(cls) if f.name not in cls.NOT_COLUMNS]

    @property
    def epochs(self) -> int:
        """Number of rows."""
        return len(getattr(self, self.columns()[0]))

    def part(self, start: int, stop: int) -> Self:
        """Epochs ``start`` to ``stop``, in memory."""
        return replace(self, **{name: getattr(self, name)[start:stop] for name in self.columns()})

    def parts(self, epochs: int = PART_EPOCHS) -> Iterator[Self]:
        """Split the whole track in parts of so many epochs, each in memory."""
        return (self.part(at, at + epochs) for at in range(0, self.epochs, epochs))

    def in_memory(self) -> Self:
        """Read the whole track."""
        return self

    def between(self, start_s: float, stop_s: float) -> Self:
        """Epochs whose time lies in [start_s, stop_s], in memory."""

        rows = range(self.epochs)
        first = bisect_left(rows, start_s, key=self.time_at)
        return self.part(first, bisect_right(rows, stop_s, key=self.time_at))

    def time_at(self, row: int) -> float:
        """Time of one epoch."""
        return float(self.time_s[row])

    def sampled(self, most: int) -> Self:
        """Every n-th epoch of the track, no more than ``most`` in all, in memory."""
        step = -(-self.epochs // most)
        if step <= 1:
            return self.in_memory()
        kept: dict[str, list[NDArray[Any]]] = {name: [] for name in self.columns()}
        for part in self.parts(step * max(1, PART_EPOCHS // step)):
            for name, values in kept.items():
                values.append(getattr(part, name)[::step].copy())
        return replace(self.part(0, 0), **{n: np.concatenate(v) for n, v in kept.items()})


@dataclass(frozen=True)
class SignalTrack(Track):
    """Epochs of one signal of one satellite."""

    NOT_COLUMNS = frozenset({"signal", "prn", "modulation", "tap_offsets_s", "prompt_tap"})

    signal: str
    prn: int
    modulation: str
    """How the replica's chips are shaped: Bpsk, Boc11 or Qmboc."""
    tap_offsets_s: NDArray[np.float64]
    """Replica delay of each correlator tap (positive = late), shape (taps,)."""
    prompt_tap: int
    time_s: NDArray[np.float64]
    integration_s: NDArray[np.float64]
    state: NDArray[np.uint8]
    """Values of :class:`State`."""
    carrier_phase_cycles: NDArray[np.float64]
    """Measured (loop oscillator plus discriminator), continuous while ``state`` >= TRACKING."""
    doppler_hz: NDArray[np.float64]
    code_phase_chips: NDArray[np.float64]
    """Measured received code phase (oscillator plus discriminator), unwrapped; grows."""
    phase_error_cycles: NDArray[np.float64]
    """Carrier discriminator: received minus oscillator phase (growing with approach)."""
    code_error_chips: NDArray[np.float64]
    """Code discriminator: received minus replica code phase."""
    cn0_dbhz: NDArray[np.float64]
    phase_lock: NDArray[np.float64]
    """Mean of cos(2 phase error): 1 locked, 0 not."""
    noise_power: NDArray[np.float64]
    """Noise power per sample as the noise tap sees it, running mean, input units squared."""
    taps: NDArray[np.complex64]
    """Correlator outputs over the epoch, secondary code wiped where known, shape (N, taps)."""
    data_prompt: NDArray[np.complex64]
    """Prompt of the data component beside a pilot over the epoch, 0 where it is not received. It
    comes with the pilot's phase: its real part is the data symbol."""


@dataclass(frozen=True)
class ComboTrack(Track):
    """Joint epochs of the two sidebands of a satellite; rows belong to the same transmit time."""

    NOT_COLUMNS = frozenset({"prn", "lower", "upper"})

    prn: int
    lower: str
    upper: str
    time_s: NDArray[np.float64]
    integration_s: NDArray[np.float64]
    state: NDArray[np.uint8]
    """COMBO where the joint loops ran, SYNCED where each sideband ran on its own, CAPTURED where it
    did because one of them is marked as captured."""
    phase_lower_cycles: NDArray[np.float64]
    phase_upper_cycles: NDArray[np.float64]
    main_phase_cycles: NDArray[np.float64]
    """Half the sum of both phases, at (f_u + f_l) / 2."""
    subcarrier_phase_cycles: NDArray[np.float64]
    """Half the difference of both phases, upper minus lower, at (f_u - f_l) / 2."""
    subcarrier_range_m: NDArray[np.float64]
    """Pseudorange from the subcarrier's phase, its ambiguity resolved from the codes; up to whole
    code periods of the upper signal. NaN until it is resolved, and where f_u = f_l."""
    code_delay_lower_s: NDArray[np.float64]
    """Measured code delay of the lower sideband at ``time_s``, up to whole code periods."""
    code_delay_upper_s: NDArray[np.float64]
    cn0_lower_dbhz: NDArray[np.float64]
    cn0_upper_dbhz: NDArray[np.float64]
    code_difference_s: NDArray[np.float64]
    """Measured code delay, upper minus lower."""
    subcarrier_lock: NDArray[np.float64]


@dataclass(frozen=True)
class SecondPeak:
    """A search for a second signal of a tracked satellite, with the tracked one taken out."""

    signal: str
    prn: int
    found: bool
    """Whether a peak exceeds the threshold and is well away from the tracked one."""
    sample_index: int
    """Sample at which the search began."""
    code_offset_chips: float
    """Code delay of the largest peak less that of the tracked signal; positive is later."""
    doppler_offset_hz: float
    """Doppler of the largest peak less that of the tracked signal."""
    cn0_dbhz: float
    statistic: float
    threshold: float
    log10_p: float
    """log10 of the probability that noise makes as much in one search, clipped; 0 for a peak that
    is not away from the tracked one."""
    false_alarm_probability: float
    """Of one search, which sets the threshold."""


@dataclass(frozen=True)
class TrackLog:
    """Everything that tracking found in a recording."""

    recording: str
    sample_rate_hz: float
    duration_s: float
    """Length of signal that was tracked."""
    partial: bool
    """True if tracking was interrupted before the end."""
    signals: tuple[SignalTrack, ...]
    combos: tuple[ComboTrack, ...]
    second_peaks: tuple[SecondPeak, ...] = ()
    """Searches for second signals of the tracked satellites, where there were any."""
    breaks: tuple[CountBreak, ...] = ()
    gain: GainLog | None = None
    """Gain of the recorder, where it was logged; taps and noise power contain it."""


@dataclass(frozen=True)
class Alarm:
    """A latched alarm of one detector on one satellite."""

    prn: int
    detector: str
    band: str | None
    """Signal that the evidence points to, None where it cannot tell."""
    onset_s: float
    """Estimated start of the disturbance."""
    alarm_s: float
    """When the rule fired."""
    statistic: float
    threshold: float
    unit: str
    system: str = "C"
    """RINEX system letter of the satellite."""
    log10_p: float = 0.0
    """log10 of the probability that noise alone reaches the statistic in one test, clipped."""
    quantity: str = ""
    """What was measured, where the detector measures several things."""


@dataclass(frozen=True)
class SatelliteVerdict:
    """What the detectors say of one satellite."""

    prn: int
    verdict: str
    """'clean', 'suspect', 'spoofed' or 'not enough support'."""
    alarms: tuple[Alarm, ...]
    reason: str
    system: str = "C"
    """RINEX system letter of the satellite."""
    onset_s: float | None = None
    """Start of what the verdict rests on; None without an alarm."""
    band: str | None = None
    """Signal that was captured, by all evidence; None where it cannot be told."""
    band_confidence: float | None = None
    """Probability that it is this band rather than another of the satellite."""
    confidence: float | None = None
    """One minus the probability that noise alone raises such an alarm in all that was tested."""
    action: str = ""
    """What to do with the satellite, in words."""
    fallback: str | None = None
    """Signal that can still be used where another was captured."""


@dataclass(frozen=True)
class Verdict:
    """What the detectors say of a recording."""

    spoofed: bool
    satellites: tuple[SatelliteVerdict, ...]
    limits: str
    """In words, what these detectors cannot see."""

    @property
    def suspect(self) -> bool:
        """Whether any satellite is under suspicion without being called spoofed."""
        return any(s.verdict == "suspect" for s in self.satellites)
