"""From a track log to a verdict: runs the detectors, applies the rule, says what was tested."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from sdr_spoof import _core, decision, detectors
from sdr_spoof.detectors import DetectionConfig, StatisticSeries
from sdr_spoof.detectors.band_attribution import disturbed_band
from sdr_spoof.records import Alarm, SatelliteVerdict, State, TrackLog, Verdict

CLEAN, SPOOFED, NO_SUPPORT = "clean", "spoofed", "not enough support"


def detect(log: TrackLog, config: DetectionConfig | None = None) -> Verdict:
    """What the configured detectors say of every satellite in the log, and overall.

    Raises ConfigError for an unknown detector or rule. Deterministic: the same log and
    configuration give the same verdict.
    """
    config = config or DetectionConfig()
    by_satellite: dict[tuple[str, int], list[_Examined]] = defaultdict(list)
    for series in statistics(log, config):
        by_satellite[series.system, series.prn].append(_examine(log, series, config))
        del series  # before the next one is made: they are large
    satellites = tuple(
        _judge(log, system, prn, by_satellite[system, prn], config)
        for system, prn in satellites_in(log)
    )
    return Verdict(
        spoofed=any(s.verdict == SPOOFED for s in satellites),
        satellites=satellites,
        limits=limits(config),
    )


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The series of all configured detectors, one after the other, as the report draws them."""
    chosen = [detectors.find(name) for name in config.detectors]
    return chain.from_iterable(detector.statistics(log, config) for detector in chosen)


def satellites_in(log: TrackLog) -> list[tuple[str, int]]:
    """(RINEX system letter, PRN) of everything tracked, sorted."""
    names = [(t.signal, t.prn) for t in log.signals] + [(c.upper, c.prn) for c in log.combos]
    return sorted({(system_of(signal), prn) for signal, prn in names})


def system_of(signal: str) -> str:
    """RINEX system letter of a signal."""
    return str(_core.signal_spec(signal)["system"])


def limits(config: DetectionConfig) -> str:
    """In words, what the configured detectors cannot see."""
    chosen = [detectors.find(name) for name in config.detectors]
    parts = [f"{d.title} cannot see: {d.blind_to}." for d in chosen]
    return " ".join(["'Clean' means that the tests found nothing.", *parts])


@dataclass(frozen=True)
class _Examined:
    """What one series says of a satellite."""

    detector: str
    alarm: Alarm | None
    tests: int
    tested_s: float
    start_s: float
    held_until_s: float
    """Until when both bands were held; -inf for never."""
    window_s: float
    notes: tuple[str, ...]


def _examine(log: TrackLog, series: StatisticSeries, config: DetectionConfig) -> _Examined:
    return _Examined(
        detector=series.detector,
        alarm=_alarm(log, series, config),
        tests=series.time_s.size,
        tested_s=series.tested_s(),
        start_s=float(np.min(series.trace_time_s, initial=np.inf)),
        held_until_s=float(np.max(series.trace_time_s[series.trace_segment >= 0], initial=-np.inf)),
        window_s=series.window_s,
        notes=series.notes,
    )


def _judge(
    log: TrackLog, system: str, prn: int, examined: Sequence[_Examined], config: DetectionConfig
) -> SatelliteVerdict:
    by_detector: dict[str, list[_Examined]] = defaultdict(list)
    for e in examined:
        by_detector[e.detector].append(e)
    # The first alarm of a detector stays.
    found = (next((e.alarm for e in es if e.alarm), None) for es in by_detector.values())
    alarms = tuple(alarm for alarm in found if alarm is not None)
    tested_s = max((sum(e.tested_s for e in es) for es in by_detector.values()), default=0.0)
    notes = "; ".join(note for es in by_detector.values() for note in _notes(log, es))
    if alarms:
        verdict, reason = SPOOFED, _spoofed_reason(alarms[0])
    elif tested_s >= config.min_tested_s:
        count = sum(e.tests for e in examined)
        verdict = CLEAN
        reason = (
            f"{tested_s:.1f} s tested in {count} overlapping windows, none beyond the threshold"
        )
    elif examined:
        verdict = NO_SUPPORT
        reason = f"only {tested_s:.1f} s could be tested, {config.min_tested_s:g} s are needed"
    else:
        verdict, reason = NO_SUPPORT, _untested_reason(log, system, prn)
    return SatelliteVerdict(prn, verdict, alarms, f"{reason}; {notes}" if notes else reason, system)


def _notes(log: TrackLog, examined: Sequence[_Examined]) -> Iterator[str]:
    """What one detector notes of all sections of a satellite's track."""
    for e in examined:
        for note in e.notes:
            yield note if len(examined) == 1 else f"from {e.start_s:.0f} s on {note}"
    # A band was lost for good, as by a strong attack with a carrier of its own.
    until_s = max(e.held_until_s for e in examined)
    if -np.inf < until_s < log.duration_s - examined[0].window_s:
        yield f"both bands were held together only until {until_s:.2f} of {log.duration_s:.2f} s"


def _alarm(log: TrackLog, series: StatisticSeries, config: DetectionConfig) -> Alarm | None:
    decided = decision.find(config.rule)(series, config)
    if decided is None:
        return None
    track = next((c for c in log.combos if c.prn == series.prn), None)
    band = None
    if track is not None:
        near = track.between(decided.onset_s - config.attribution_fit_s, decided.alarm_s)
        band = disturbed_band(near, decided.onset_s, decided.alarm_s, config)
    return Alarm(
        prn=series.prn,
        detector=series.detector,
        band=band,
        onset_s=decided.onset_s,
        alarm_s=decided.alarm_s,
        statistic=decided.statistic,
        threshold=decided.threshold,
        unit=series.unit,
        system=series.system,
        log10_p=decided.log10_p,
    )


def _spoofed_reason(alarm: Alarm) -> str:
    if alarm.band:
        what = f"the carrier of {_composite(alarm.band)} left its course at {alarm.onset_s:.2f} s"
    else:
        what = f"one carrier left the other at {alarm.onset_s:.2f} s, which of them cannot be told"
    return (
        f"{what}; "
        f"difference rate {alarm.statistic:+.3f} {alarm.unit} against a threshold of "
        f"{alarm.threshold:.3f} {alarm.unit}"
    )


def _untested_reason(log: TrackLog, system: str, prn: int) -> str:
    held = [
        t.signal
        for t in log.signals
        if t.prn == prn and system_of(t.signal) == system and (t.state >= State.TRACKING).any()
    ]
    if not held:
        return "no signal of this satellite was held long enough to test"
    names = " and ".join(sorted({_composite(signal) for signal in held}))
    return f"received on {names} only; the test compares two bands"


def _composite(signal: str) -> str:
    """Name of a signal as users know it: B1C, not its pilot."""
    return str(_core.signal_spec(signal)["composite"])
