"""What the report keeps of every test while the series pass by: thin lines and largest values."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.detectors import DetectionConfig, StatisticSeries
from sdr_spoof.fusion import evidence_of, share_of
from sdr_spoof.records import Alarm, Verdict
from sdr_spoof.report.figures import style

DRAWN_QUALITY = ("delta_metric", "ratio_metric")
"""Tests of signal quality that the overview draws; those of power it draws as measured."""


@dataclass
class Line:
    """A line that grows section by section; thinned, so that a long track stays small."""

    label: str
    signal: str | None
    times_s: list[NDArray[np.float64]] = field(default_factory=list)
    values: list[NDArray[np.float64]] = field(default_factory=list)

    def add(self, time_s: NDArray[np.float64], value: NDArray[np.float64]) -> None:
        """Add rows; the line breaks where values are NaN."""
        thin_s, thin = style.thinned(time_s, value)
        self.times_s.append(thin_s)
        self.values.append(thin)

    def joined(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The whole line: time and value, N rows each."""
        if not self.times_s:
            return np.empty(0), np.empty(0)
        return np.concatenate(self.times_s), np.concatenate(self.values)

    @property
    def end_s(self) -> float:
        """Last time that it has."""
        return float(self.times_s[-1][-1]) if self.times_s else -np.inf


@dataclass(frozen=True)
class Cell:
    """One detector on one satellite."""

    of_threshold: float
    """Largest |statistic| / threshold."""
    alarm_s: float | None = None
    """When it first raised an alarm."""


@dataclass
class Evidence:
    """What all series say of one satellite."""

    difference: Line = field(default_factory=lambda: Line("phase difference", None))
    """Carrier-scaled phase difference in cycles of the upper carrier."""
    consistency: dict[tuple[str, str | None], Line] = field(default_factory=dict)
    """|statistic| / threshold, by detector and signal."""
    quality: dict[tuple[str, str | None], Line] = field(default_factory=dict)
    """Statistic / threshold, by detector and signal; of those in DRAWN_QUALITY."""
    cells: dict[str, Cell] = field(default_factory=dict)
    """By detector."""
    _difference_of: str | None = None

    def take(self, series: StatisticSeries, config: DetectionConfig) -> None:
        """Keep what the report needs of a series that is not empty."""
        ratio = series.value / series.threshold(config.false_alarm_probability)
        known = self.cells.get(series.detector, Cell(0.0))
        largest = max(known.of_threshold, float(np.abs(ratio).max()))
        self.cells[series.detector] = Cell(largest)
        of = series.detector, series.signal
        if evidence_of(series.detector) == "consistency":
            line = self.consistency.setdefault(of, Line(series.detector, series.signal))
            line.add(*broken(series, np.abs(ratio)))
        elif series.detector in DRAWN_QUALITY:
            line = self.quality.setdefault(of, Line(series.detector, series.signal))
            line.add(*broken(series, ratio))
        if series.detector.startswith("phase_difference"):
            self._difference_of = self._difference_of or series.detector
            if series.detector == self._difference_of:
                self._add_difference(series)

    def judge(self, alarms: Sequence[Alarm]) -> None:
        """Enter when each detector first alarmed."""
        for name, cell in self.cells.items():
            first_s = min((a.alarm_s for a in alarms if a.detector == name), default=None)
            self.cells[name] = replace(cell, alarm_s=first_s)

    def _add_difference(self, series: StatisticSeries) -> None:
        """Go on where the last section ended: sections overlap, and start from levels of theirs."""
        values = joined(series)
        fresh = series.trace_time_s > self.difference.end_s
        past_s, past = self.difference.joined()
        if past.size and np.isfinite(past).any():
            shared = np.interp(past_s[-20:], series.trace_time_s, values)
            offset = np.nanmedian(past[-20:] - shared)
            values = values + (offset if np.isfinite(offset) else 0.0)
        self.difference.add(series.trace_time_s[fresh], values[fresh])


def joined(series: StatisticSeries) -> NDArray[np.float64]:
    """Trace from its level at the start; NaN where it is not used.

    The phase after a loss of lock is arbitrary, so each piece goes on where the last one ended.
    """
    values = np.full(series.trace.shape, np.nan)
    level = 0.0
    for number in np.unique(series.trace_segment[series.trace_segment >= 0]):
        rows = np.flatnonzero(series.trace_segment == number)
        values[rows] = series.trace[rows] - np.median(series.trace[rows[:20]]) + level
        level = float(np.median(values[rows[-20:]]))
    return values


def broken(
    series: StatisticSeries, *columns: NDArray[np.float64]
) -> tuple[NDArray[np.float64], ...]:
    """Times and columns with a NaN between pieces and across untested stretches: lines break."""
    step = np.diff(series.time_s)
    usual = float(np.median(step)) if step.size else 0.0
    cuts = np.flatnonzero((np.diff(series.segment) != 0) | (step > 1.5 * usual)) + 1
    # A time where the line is interrupted, so that thinned lines stay in order.
    times = np.insert(series.time_s, cuts, series.time_s[cuts - 1] + 0.5 * usual)
    return times, *(np.insert(column, cuts, np.nan) for column in columns)


@dataclass
class EvidenceBook:
    """Evidence of all satellites, gathered while detection runs: ``detect(look=book.take)``."""

    config: DetectionConfig
    """What the tests are made with, all detectors together."""
    satellites: dict[tuple[str, int], Evidence] = field(
        default_factory=lambda: defaultdict(Evidence)
    )
    """By (system, PRN)."""

    def take(self, series: StatisticSeries) -> None:
        """Keep what the report needs of a series."""
        if series.time_s.size:
            self.satellites[series.system, series.prn].take(series, share_of(self.config))

    def judge(self, verdict: Verdict) -> None:
        """Enter the alarms."""
        for satellite in verdict.satellites:
            if (key := (satellite.system, satellite.prn)) in self.satellites:
                self.satellites[key].judge(satellite.alarms)

    def rows(
        self, names: tuple[str, ...], order: list[tuple[str, int]]
    ) -> Iterator[tuple[tuple[str, int], list[Cell | None]]]:
        """A table: per satellite that was tested, one cell per detector."""
        for key in order:
            if key in self.satellites:
                cells = self.satellites[key].cells
                yield key, [cells.get(name) for name in names]
