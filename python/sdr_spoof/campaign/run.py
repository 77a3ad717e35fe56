"""One run: a pure function of point and seed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.fusion import evidence_of, share_of
from sdr_spoof.records import State
from sdr_spoof.signals import satellite_name, system_of
from sdr_spoof.verdict import detect

from .columns import columns_of
from .levels import LEVELS, subjects

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sdr_spoof.detectors import DetectionConfig, StatisticSeries
    from sdr_spoof.records import SatelliteVerdict, TrackLog, Verdict
    from sdr_spoof.scenario import Scenario

    from .columns import Value
    from .points import Point

Row = dict[str, "Value"]


def run(point: Point, seed: int) -> Row:
    """Simulate, track, detect; see :mod:`sdr_spoof.campaign.columns` for what is returned.

    The result depends on nothing but the arguments: not on the process, nor on threads.
    """
    return observe(point, LEVELS[point.level](point, seed))


def observe(point: Point, log: TrackLog) -> Row:
    """What detection says of a track log made at a point, beside the truth."""
    row: Row = {c.name: None for c in columns_of(point)}
    scores = _Scores(point.detection)
    found = _verdicts(detect(log, point.detection, scores.look)) | _tracking(log)
    for name, truth in truths(point.scenario).items():
        found |= _prefix(name, truth)
        for detector in point.detection.detectors:
            key = f"{name}.{detector}"
            found.setdefault(f"{key}.alarmed", False)
            found[f"{key}.score"] = scores.scores.get(key)
            found[f"{key}.tested_s"] = scores.tested_s(key)
    return row | {key: value for key, value in found.items() if key in row}


def truths(scenario: Scenario) -> dict[str, Row]:
    """Kind and times of the attacks on each satellite; the first of each time."""
    timelines: dict[str, list[dict[str, Any]]] = {name: [] for name in subjects(scenario)}
    for number, attack in enumerate(scenario.attack):
        for satellite, signals in scenario.victims(number):
            about = {"kind": attack.kind, "hostile": attack.hostile}
            timeline = about | attack.timeline(satellite, signals)
            timelines[satellite_name(satellite.system, satellite.prn)].append(timeline)
    return {name: _truth(found) for name, found in timelines.items()}


def _truth(timelines: list[dict[str, Any]]) -> Row:
    return {
        "attack": "+".join(dict.fromkeys(t["kind"] for t in timelines)),
        "hostile": any(t["hostile"] for t in timelines),
        "attack_start_s": _first(t["start_s"] for t in timelines),
        "capture_s": _first(t.get("capture_s") for t in timelines),
        "drag_start_s": _first(t.get("drag_start_s") for t in timelines),
    }


def _verdicts(verdict: Verdict) -> Row:
    row: Row = {}
    for satellite in verdict.satellites:
        name = satellite_name(satellite.system, satellite.prn)
        row |= _prefix(name, _verdict(satellite))
        # The last one written stays: the first alarm of each detector.
        for alarm in sorted(satellite.alarms, key=lambda a: a.alarm_s, reverse=True):
            found: Row = {
                "alarmed": True,
                "alarm_s": alarm.alarm_s,
                "onset_s": alarm.onset_s,
                "band": alarm.band or "",
            }
            row |= _prefix(f"{name}.{alarm.detector}", found)
    return row


def _verdict(satellite: SatelliteVerdict) -> Row:
    consistent = [a for a in satellite.alarms if evidence_of(a.detector) == "consistency"]
    return {
        "verdict": satellite.verdict,
        "alarm_s": _first(a.alarm_s for a in consistent or satellite.alarms),
        "onset_s": satellite.onset_s,
        "band": satellite.band or "",
        "confidence": satellite.confidence,
    }


def _tracking(log: TrackLog) -> Row:
    row: Row = {}
    for track in log.signals:
        name = f"{satellite_name(system_of(track.signal), track.prn)}.{track.signal}"
        held = track.state >= State.SYNCED
        if held.any():
            row[f"{name}.held_until_s"] = float(track.time_s[held][-1])
            row[f"{name}.cn0_dbhz"] = float(track.cn0_dbhz[held].mean())
    return row


class _Scores:
    """Largest statistic over threshold, and tested time, of each satellite and detector.

    A detector may have several series of one satellite: of several signals, whose tested times lie
    beside each other, or of the sections of a long track, whose tested times add up.
    """

    def __init__(self, config: DetectionConfig) -> None:
        self.scores: dict[str, float] = {}
        self._config = share_of(config)
        self._tested_s: dict[str, dict[tuple[str | None, str], float]] = {}

    def look(self, series: StatisticSeries) -> None:
        key = f"{satellite_name(series.system, series.prn)}.{series.detector}"
        which = (series.signal, series.quantity)
        times = self._tested_s.setdefault(key, {})
        times[which] = times.get(which, 0.0) + series.tested_s()
        if series.value.size:
            threshold = series.threshold(self._config.false_alarm_probability)
            score = float(np.max(np.abs(series.value) / threshold))
            self.scores[key] = max(score, self.scores.get(key, 0.0))

    def tested_s(self, key: str) -> float:
        return max(self._tested_s.get(key, {}).values(), default=0.0)


def _prefix(prefix: str, values: Row) -> Row:
    return {f"{prefix}.{name}": value for name, value in values.items()}


def _first(times: Iterable[float | None]) -> float | None:
    return min((t for t in times if t is not None), default=None)
