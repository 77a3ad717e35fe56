"""From observations, an INS and DME to alarms, the satellites behind them, and the position.

Tests: each satellite's difference against the others and the INS, each satellite against the
others alone, and DME against the INS (:data:`TESTS`). Each is decided by the configured rule; the
false alarms are shared among all channels. What a test or a rule cannot judge is said in the notes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.decision import Decision, Refusal
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.errors import AidingError

from .config import SequentialConfig
from .drift import Drift
from .isolation import Isolation, isolate
from .observed import Differences, differences
from .statistics import STATISTICS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements

    from .geometry import Geometry
    from .records import DmeLog

TESTS = ("difference-clock-free", "parity-by-satellite", "dme-difference")
DME = "dme-difference"


@dataclass(frozen=True)
class Tested:
    """One channel of one test, and what the rule says of it."""

    test: str
    channel: str
    """A satellite, or two stations."""
    series: StatisticSeries
    decided: Decision | None
    note: str
    """Why it was not judged; empty where it was."""


@dataclass(frozen=True)
class Judgement:
    """What was found."""

    differences: Differences
    tested: tuple[Tested, ...]
    alarm_s: float | None
    """First alarm of all."""
    captured: bool
    """Whether DME says that the INS is where it should not be: then it cannot isolate."""
    isolation: Isolation | None
    """At the end of the isolation window; satellites are numbers of the columns."""
    notes: tuple[str, ...]

    @property
    def spoofed(self) -> tuple[str, ...]:
        """Satellites to be left out."""
        found = () if self.isolation is None else (self.isolation.satellites or ())
        return tuple(self.differences.satellites[j] for j in found)


def judge(
    measurements: Measurements,
    ins: InertialStates,
    dme: DmeLog | None = None,
    config: SequentialConfig | None = None,
    rate: RateConfig | None = None,
) -> Judgement:
    """Run all tests; ``rate`` says how well a free INS was aligned.

    Raises:
        AidingError, NavigationError: records do not go together, or are too few.
        ConfigError: no such rule, or no such grade of INS.
    """
    config = config or SequentialConfig()
    found = differences(measurements, ins, dme, config)
    drift = Drift.of(measurements, ins, config, rate)
    if drift is not None:
        found = drift.expected(found)
    series, notes = [], []
    for name in TESTS:
        if name == DME and dme is None:
            continue
        made, said = _series(found, name)
        series += made
        notes += said
    each = config.false_alarms_per_hour / max(len(series), 1)
    detection = DetectionConfig(rule=config.rule, false_alarms_per_hour=each)
    tested = tuple(_decided(test, channel, s, detection) for test, channel, s in series)
    notes += list(dict.fromkeys(t.note for t in tested if t.note))
    alarms = [(t.decided.alarm_s, t) for t in tested if t.decided is not None]
    captured = any(t.test == DME for _, t in alarms)
    alarm_s, first = min(alarms, key=lambda a: a[0], default=(None, None))
    isolation = None
    if alarm_s is not None and first is not None and first.decided is not None:
        # What came after the onset has taught the filter wrong.
        known = found if drift is None else drift.expected(found, first.decided.onset_s)
        isolation = _isolated(known, alarm_s, captured, config)
    return Judgement(found, tested, alarm_s, captured, isolation, tuple(notes))


def _decided(test: str, channel: str, series: StatisticSeries, config: DetectionConfig) -> Tested:
    said = decision.decide(series, config)
    if isinstance(said, Refusal):
        return Tested(test, channel, series, None, f"{test}, {channel}: {said.reason}")
    return Tested(test, channel, series, said, "")


def _series(
    found: Differences, name: str
) -> tuple[list[tuple[str, str, StatisticSeries]], list[str]]:
    """Channels of a test over all epochs, and what could not be tested."""
    statistic = STATISTICS[name]
    stations = found.differences_m.shape[1] - found.count
    channels = (
        list(found.satellites)
        if statistic.by_satellite
        else [f"DME 1 - {k + 2}" for k in range(max(stations - 1, 0))]
    )
    values = np.full((found.time_s.size, len(channels)), np.nan)
    objections: dict[str, int] = {}
    for epoch in range(found.time_s.size):
        try:
            _fill(values[epoch], found, epoch, name)
        except AidingError as error:
            objections[str(error)] = objections.get(str(error), 0) + 1
    notes = [f"{name}: {count} epochs: {what}" for what, count in objections.items()]
    made = [
        (name, channel, _one(found, name, channel, values[:, k]))
        for k, channel in enumerate(channels)
    ]
    return [m for m in made if m[2].time_s.size], notes


def _fill(row: NDArray[np.float64], found: Differences, epoch: int, name: str) -> None:
    """Channels of one epoch, in place."""
    known = found.known(epoch)
    satellites = known[known < found.count]
    if name != DME:
        row[satellites] = found.channels(STATISTICS[name], epoch, satellites)
        return
    stations = known[known >= found.count]
    if not stations.size or stations[0] != found.count:
        raise AidingError("the first DME station is missing; the others are compared with it")
    geometry = found.geometry(epoch, stations)
    kept = _apart(geometry)
    values = found.channels(STATISTICS[name], epoch, stations)
    row[(stations[1:] - found.count - 1)[kept]] = values


def _apart(geometry: Geometry) -> NDArray[np.bool_]:
    from .statistics.dme_difference import LEAST_APART  # noqa: PLC0415

    design = geometry.design[:, :3]
    return np.asarray(np.linalg.norm(design[0] - design[1:], axis=1) > LEAST_APART)


def _one(
    found: Differences, name: str, channel: str, values: NDArray[np.float64]
) -> StatisticSeries:
    there = np.isfinite(values)
    time_s, z = found.time_s[there], values[there]
    step_s = float(np.median(np.diff(found.time_s))) if found.time_s.size > 1 else 1.0
    ones = np.ones(z.size)
    # A gap does not end what a rule has gathered: the next sample is as independent as the last.
    segment = np.zeros(z.size, np.int64)
    letter, number = (channel[0], int(channel[1:])) if name != DME else ("", 0)
    return StatisticSeries(
        detector=name,
        system=letter,
        prn=number,
        unit="sigma",
        time_s=time_s,
        value=z,
        sigma=ones,
        sigma_thermal=ones,
        segment=segment,
        window_s=step_s,
        trace_time_s=time_s,
        trace=z,
        trace_unit=f"{STATISTICS[name].title.lower()}, standard deviations",
        trace_segment=segment,
        notes=(),
    )


def _isolated(
    found: Differences, alarm_s: float, captured: bool, config: SequentialConfig
) -> Isolation | None:
    """From the means over the seconds after the alarm, or the alarm's epoch where none follow."""
    last = alarm_s + config.isolation_s
    rows = np.flatnonzero((found.time_s > alarm_s) & (found.time_s <= last))
    rows = rows if rows.size else np.flatnonzero(found.time_s == alarm_s)
    columns = np.flatnonzero(np.isfinite(found.differences_m[rows]).all(axis=0))
    sats = columns[columns < found.count]
    if sats.size < 2:
        return None
    middle = int(rows[rows.size // 2])
    geometry = found.geometry(middle, sats)
    mean = found.differences_m[rows][:, sats].mean(axis=0)
    expected = found.error_m[rows].mean(axis=0), found.error_m2[middle]
    made = isolate(mean, geometry, rows.size, trusted=not captured, expected=expected)
    named = None if made.satellites is None else tuple(int(sats[j]) for j in made.satellites)
    return Isolation(named, made.before_m, made.after_m, made.unique)
