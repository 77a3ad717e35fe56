"""From a track log to a verdict: runs the detectors, applies the rule, fuses what they say."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from itertools import chain

import numpy as np

from sdr_spoof import decision, detectors
from sdr_spoof.decision import Decision, Refusal
from sdr_spoof.detectors import DetectionConfig, StatisticSeries
from sdr_spoof.detectors.band_attribution import common_clock, disturbed_band
from sdr_spoof.fusion import (
    CLEAN,
    NO_SUPPORT,
    SPOOFED,
    SUSPECT,
    Examined,
    evidence_of,
    judge,
    share_of,
)
from sdr_spoof.records import Alarm, TrackLog, Verdict
from sdr_spoof.satellites import combos_of, satellites_in

__all__ = ["CLEAN", "NO_SUPPORT", "SPOOFED", "SUSPECT", "detect", "statistics"]


LATER_S = (0.0, 0.5, 1.0, 2.0)
"""How long after an alarm of a test with short windows the carriers are looked at, as long as they
do not tell the band."""


def detect(
    log: TrackLog,
    config: DetectionConfig | None = None,
    look: Callable[[StatisticSeries], None] | None = None,
) -> Verdict:
    """What the configured detectors say of every satellite in the log, and overall.

    ``look`` is shown every series before it goes. Raises ConfigError for an unknown detector or
    rule. Deterministic: the same log and configuration give the same verdict.
    """
    config = config or DetectionConfig()
    by_satellite: dict[tuple[str, int], list[Examined]] = defaultdict(list)
    for series in statistics(log, config):
        by_satellite[series.system, series.prn].append(_examine(log, series, config))
        if look is not None:
            look(series)
        del series  # before the next one is made: they are large
    satellites = tuple(
        judge(log, system, prn, by_satellite[system, prn], config)
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
    share = share_of(config)
    return chain.from_iterable(detector.statistics(log, share) for detector in chosen)


def limits(config: DetectionConfig) -> str:
    """In words, what the configured detectors cannot see."""
    titles: dict[str, list[str]] = defaultdict(list)
    for name in dict.fromkeys(config.detectors):
        detector = detectors.find(name)
        titles[detector.blind_to].append(detector.title)
    parts = [f"{'; '.join(names)} cannot see: {blind}." for blind, names in titles.items()]
    return " ".join(["'Clean' means that the tests found nothing.", *parts])


def _examine(log: TrackLog, series: StatisticSeries, config: DetectionConfig) -> Examined:
    decided = decision.decide(series, share_of(config))
    refused = isinstance(decided, Refusal)
    return Examined(
        detector=series.detector,
        signal=series.signal,
        quantity=series.quantity,
        alarm=_alarm(log, series, config, decided) if isinstance(decided, Decision) else None,
        tests=0 if refused else series.time_s.size,
        tested_s=0.0 if refused else series.tested_s(),
        start_s=float(np.min(series.trace_time_s, initial=np.inf)),
        held_until_s=float(np.max(series.trace_time_s[series.trace_segment >= 0], initial=-np.inf)),
        window_s=series.window_s,
        notes=(*series.notes, decided.reason) if isinstance(decided, Refusal) else series.notes,
    )


def _alarm(
    log: TrackLog, series: StatisticSeries, config: DetectionConfig, decided: Decision
) -> Alarm:
    return Alarm(
        prn=series.prn,
        detector=series.detector,
        band=series.signal or _band(log, series, decided, config),
        onset_s=decided.onset_s,
        alarm_s=decided.alarm_s,
        statistic=decided.statistic,
        threshold=decided.threshold,
        unit=decided.unit or series.unit,
        system=series.system,
        log10_p=decided.log10_p,
        quantity=series.quantity,
    )


def _band(
    log: TrackLog, series: StatisticSeries, decided: Decision, config: DetectionConfig
) -> str | None:
    """The band whose carrier left its course, after what the receiver's clock explains."""
    found = combos_of(log, series.system, series.prn)
    if not found or evidence_of(series.detector) == "quality":
        return None
    start_s = decided.onset_s - config.attribution_fit_s
    # Short windows alarm before either carrier has left its own course by enough to be named.
    later_s = LATER_S if series.shortest_s is not None else LATER_S[:1]
    for stop_s in (decided.alarm_s + later for later in later_s):
        near = found[0].between(start_s, stop_s)
        clock = common_clock(log, (series.system, series.prn), decided.onset_s, stop_s, config)
        band = disturbed_band(near, decided.onset_s, stop_s, config, clock)
        if band is not None:
            return band
    return None
