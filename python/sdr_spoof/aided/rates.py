"""The tests of carrier-phase rates against an INS, as monitors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.aiding import detectors
from sdr_spoof.signals import satellite_name

from .records import Monitor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

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


def joined(parts: Sequence[Rates], time_s: NDArray[np.float64]) -> Rates:
    """Stretches of a recording as one, on all its epochs."""
    return Rates(
        _monitors([part.monitors for part in parts], time_s),
        _monitors([part.residuals for part in parts], time_s),
        tuple(dict.fromkeys(note for part in parts for note in part.notes)),
        parts[0].limits,
        sum(part.tests for part in parts),
    )


def _monitors(
    parts: Sequence[tuple[Monitor, ...]], time_s: NDArray[np.float64]
) -> tuple[Monitor, ...]:
    """Those of one name as one; the first alarm stays."""
    by_name: dict[str, list[Monitor]] = {}
    for monitor in (m for part in parts for m in part):
        by_name.setdefault(monitor.name, []).append(monitor)
    return tuple(_one(found, time_s) for found in by_name.values())


def _one(found: Sequence[Monitor], time_s: NDArray[np.float64]) -> Monitor:
    value, threshold = np.full((2, time_s.size), np.nan)
    for part in found:
        rows = np.searchsorted(time_s, part.time_s - 1e-6)
        value[rows], threshold[rows] = part.value, part.threshold
    alarmed = next((m for m in found if m.alarm_s is not None), found[0])
    return replace(
        alarmed,
        time_s=time_s,
        value=value,
        threshold=threshold,
        log10_p=min(m.log10_p for m in found),
    )


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
