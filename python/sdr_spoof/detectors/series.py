"""What a detector hands to a decision rule: a statistic with its law under H0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.records import Alarm, SignalTrack, TrackLog

LOG10_P_FLOOR = -30.0
"""Significance is clipped here: no noise model is trusted further into its tail."""


@dataclass(frozen=True)
class StatisticSeries:
    """One detector's statistic on one satellite, or on a section of it; H0: value ~ N(0, sigma^2).

    Rows are tests, N in all; ``time_s`` is the *end* of the signal that a row has used. The trace
    is the measurement under the statistic, M rows, in which a rule may look for the onset.
    """

    detector: str
    system: str
    prn: int
    unit: str
    time_s: NDArray[np.float64]
    value: NDArray[np.float64]
    sigma: NDArray[np.float64]
    """Standard deviation under H0 of the law that sets the threshold, shape (N,)."""
    sigma_thermal: NDArray[np.float64]
    """Standard deviation of the statistic from thermal noise alone, shape (N,)."""
    segment: NDArray[np.int64]
    """Number of the unbroken piece of tracking that a row lies in, shape (N,)."""
    window_s: float
    trace_time_s: NDArray[np.float64]
    trace: NDArray[np.float64]
    trace_unit: str
    trace_segment: NDArray[np.int64]
    """Piece of tracking of each trace row, -1 where the row is not used, shape (M,)."""
    notes: tuple[str, ...]
    """In words: what limited the support, what was repaired."""
    signal: str | None = None
    """The one signal that it is of; None where it compares signals."""
    quantity: str = ""
    """What is measured, in words, where a detector has several series for one signal."""
    share: float = 1.0
    """Part of the detector's false-alarm probability that this series may use: the shares of all
    its series for one satellite add up to at most 1."""
    shortest_s: float | None = None
    """Shortest of several windows, where ``window_s`` is the longest."""
    threshold_sigmas: float | None = None
    """Threshold in standard deviations that the detector's own law sets, for a rate of false
    alarms over all its overlapping windows; None where a probability per test sets it."""

    def raised(self, alarm: Alarm) -> bool:
        """Whether an alarm is of this series, in any section of the track."""
        of = (alarm.system, alarm.prn, alarm.detector, alarm.quantity)
        mine = (self.system, self.prn, self.detector, self.quantity)
        return of == mine and self.signal in (None, alarm.band)

    def covers(self, time_s: float) -> bool:
        """Whether one of its tests may have this time: the sections of a track do not overlap."""
        return bool(self.time_s.size) and bool(self.time_s[0] <= time_s <= self.time_s[-1])

    def tested_s(self) -> float:
        """Length of signal that entered at least one test, in s."""
        total = 0.0
        for number in np.unique(self.segment):
            times = self.time_s[self.segment == number]
            steps = np.diff(times)
            first_s = self.shortest_s or self.window_s
            total += first_s + float(np.minimum(steps, self.window_s).sum())
        return total

    def threshold(self, pfa: float) -> NDArray[np.float64]:
        """Two-sided threshold at a false-alarm probability per test of the detector, shape (N,).

        The detector's own where it sets one.
        """
        if self.threshold_sigmas is not None:
            return self.sigma * self.threshold_sigmas
        return np.asarray(self.sigma * -float(scipy.special.ndtri(pfa * self.share / 2.0)))

    def log10_p(self, row: int) -> float:
        """log10 of the two-sided H0 probability of a row, clipped at LOG10_P_FLOOR."""
        z = abs(float(self.value[row])) / float(self.sigma[row])
        log10_p = (float(scipy.special.log_ndtr(-z)) + np.log(2.0)) / np.log(10.0)
        return float(np.clip(log10_p, LOG10_P_FLOOR, 0.0))


def signals_of(log: TrackLog, track: SignalTrack) -> int:
    """Number of signals of the same satellite in the log."""
    system = _core.signal_spec(track.signal)["system"]
    return sum(
        t.prn == track.prn and _core.signal_spec(t.signal)["system"] == system for t in log.signals
    )
