"""One run: a pure function of point and seed."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.records import State
from sdr_spoof.scenario.attacks import capture_time_s
from sdr_spoof.signals import satellite_name
from sdr_spoof.verdict import detect, statistics

from .columns import columns_of
from .levels import LEVELS, tracked_signals

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sdr_spoof.detectors import DetectionConfig
    from sdr_spoof.records import SatelliteVerdict, TrackLog
    from sdr_spoof.scenario import Satellite, Scenario

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
    scores, tested_s = _scores(log, point.detection)
    verdicts = {satellite_name(s.system, s.prn): s for s in detect(log, point.detection).satellites}
    row: Row = {c.name: None for c in columns_of(point)}
    for satellite in point.scenario.satellite:
        name = satellite_name(satellite.system, satellite.prn)
        found = _prefix(name, truth_of(point.scenario, satellite))
        found |= _tracking(name, satellite, log)
        for detector in point.detection.detectors:
            key = f"{name}.{detector}"
            tested = {"score": scores.get(key), "tested_s": tested_s.get(key, 0.0)}
            found |= _prefix(key, {"alarmed": False, **tested})
        if name in verdicts:
            found |= _verdict(name, verdicts[name])
        row |= {key: value for key, value in found.items() if key in row}
    return row


def truth_of(scenario: Scenario, satellite: Satellite) -> Row:
    """Kind and times of the attacks on a satellite; the first of each time."""
    attacks = [a for a in scenario.attack if scenario.target(a) == satellite]
    return {
        "attack": "+".join(dict.fromkeys(a.kind for a in attacks)),
        "attack_start_s": _first(a.start_s for a in attacks),
        "capture_s": _first(capture_time_s(a) for a in attacks),
        "drag_start_s": _first(a.drag_start_s for a in attacks),
    }


def _verdict(name: str, verdict: SatelliteVerdict) -> Row:
    row: Row = {f"{name}.verdict": verdict.verdict}
    for alarm in verdict.alarms:
        row |= _prefix(
            f"{name}.{alarm.detector}",
            {
                "alarmed": True,
                "alarm_s": alarm.alarm_s,
                "onset_s": alarm.onset_s,
                "band": alarm.band or "",
            },
        )
    return row


def _tracking(name: str, satellite: Satellite, log: TrackLog) -> Row:
    row: Row = {}
    for track in log.signals:
        if track.prn != satellite.prn or track.signal not in tracked_signals(satellite):
            continue
        held = track.state >= State.SYNCED
        if held.any():
            row[f"{name}.{track.signal}.held_until_s"] = float(track.time_s[held][-1])
            row[f"{name}.{track.signal}.cn0_dbhz"] = float(track.cn0_dbhz[held].mean())
    return row


def _scores(log: TrackLog, config: DetectionConfig) -> tuple[dict[str, float], dict[str, float]]:
    """Largest statistic over threshold, and tested time, of each satellite and detector."""
    scores: dict[str, float] = {}
    tested_s: dict[str, float] = defaultdict(float)
    for series in statistics(log, config):
        key = f"{satellite_name(series.system, series.prn)}.{series.detector}"
        tested_s[key] += series.tested_s()
        if series.value.size:
            threshold = series.threshold(config.false_alarm_probability)
            score = float(np.max(np.abs(series.value) / threshold))
            scores[key] = max(score, scores.get(key, 0.0))
    return scores, tested_s


def _prefix(prefix: str, values: Row) -> Row:
    return {f"{prefix}.{name}": value for name, value in values.items()}


def _first(times: Iterable[float | None]) -> float | None:
    return min((t for t in times if t is not None), default=None)
