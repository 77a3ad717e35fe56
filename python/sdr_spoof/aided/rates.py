"""The tests of carrier-phase rates against an INS, as monitors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.aiding import detectors
from sdr_spoof.signals import satellite_name

from .records import Monitor

if TYPE_CHECKING:
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.config import Config
    from sdr_spoof.detectors.series import StatisticSeries

DIRECTIONS = ("east", "north", "up")


@dataclass(frozen=True)
class Rates:
    """What the tests of rates say."""

    monitors: tuple[Monitor, ...]
    residuals: tuple[Monitor, ...]
    """Those by east, north, up, of the first test that has them."""
    notes: tuple[str, ...]
    limits: tuple[str, ...]
    """What the tests cannot see."""
    tests: float
    """Independent tests made."""


def examine(measurements: Measurements, states: InertialStates, config: Config) -> Rates:
    """Run the configured tests.

    Raises:
        ConfigError: there is no such test, rule or grade of IMU.
        NavigationError: INS and measurements do not overlap.
    """
    monitors: list[Monitor] = []
    residuals: list[Monitor] = []
    notes: dict[str, None] = {}
    limits, tests = [], 0.0
    for name in config.aided.detectors:
        detector = detectors.find(name)
        limits.append(f"{detector.title} cannot see: {detector.blind_to}.")
        seen = list(detector.statistics(measurements, states, config))
        by_axis = [_monitor(s, s.quantity, measurements, config) for s in seen if _is_axis(s)]
        residuals = residuals or by_axis
        for series in seen:
            monitors.append(_monitor(series, _name(detector.title, series), measurements, config))
            notes |= dict.fromkeys(f"{detector.title}: {note}" for note in series.notes)
            tests += series.tested_s() / series.window_s if series.time_s.size else 0.0
    return Rates(tuple(monitors), tuple(residuals), tuple(notes), tuple(limits), tests)


def _is_axis(series: StatisticSeries) -> bool:
    return series.quantity in DIRECTIONS


def _name(title: str, series: StatisticSeries) -> str:
    of = satellite_name(series.system, series.prn) if series.system else series.quantity
    return f"{title}, {of}" if of else title


def _monitor(
    series: StatisticSeries, name: str, measurements: Measurements, config: Config
) -> Monitor:
    """A series on the epochs of the measurements, and what the rule decides."""
    time_s = measurements.time_s
    value, threshold = np.full((2, time_s.size), np.nan)
    rows = np.clip(np.searchsorted(time_s, series.time_s - 1e-6), 0, time_s.size - 1)
    value[rows] = series.value
    threshold[rows] = series.threshold(config.detection.false_alarm_probability)
    decided = decision.decide(series, config.detection) if series.time_s.size else None
    if isinstance(decided, decision.Refusal):
        decided = None
    return Monitor(
        name,
        time_s,
        value,
        threshold,
        series.unit,
        None if decided is None else decided.alarm_s,
        None if decided is None else decided.onset_s,
        0.0 if decided is None else decided.log10_p,
        decides=True,
    )
