"""From the alarms of all detectors to one verdict per satellite. The rule, in order:

1. **spoofed**: a test of consistency has alarmed: things parted that only an attack parts.
   Unless a reflection explains it (:mod:`.reflection`): the peaks of *all* bands were bent at once,
   no power rose, and carriers and codes have stayed within what an echo can do. Then it is
2. **suspect**, as it is where only tests of signal quality have alarmed. Multipath and interference
   change the shape of a peak and power too, so they alone never mean spoofing.
3. **clean**: no alarm, and a test that could have said 'spoofed' covered ``min_tested_s``.
4. **not enough support**: anything else.

Alarms latch, so verdicts do. The onset is the median of what the alarms say that date the event
before the first deciding alarm.

False alarms: ``false_alarms_per_hour`` is the rate for one satellite by all detectors together. It
is shared equally among the configured ones, and a detector with several series shares its part
among them (Bonferroni; exact to first order and never above the stated one, whatever the
dependence). ``false_alarm_probability``, of one test, is shared alike; only the published test
``phase_difference_rate`` states one. The confidence of a verdict takes the number of independent
tests into account that were made.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import median_high

import numpy as np

from sdr_spoof import detectors, reflection
from sdr_spoof.attribution import Attribution, attribute
from sdr_spoof.detectors import DetectionConfig, second_peak
from sdr_spoof.records import Alarm, SatelliteVerdict, State, TrackLog
from sdr_spoof.satellites import combos_of, tracks_of
from sdr_spoof.signals import signal_spec

BOTH_CHANGED = "both bands changed"
CLEAN, SUSPECT, SPOOFED, NO_SUPPORT = "clean", "suspect", "spoofed", "not enough support"


@dataclass(frozen=True)
class Examined:
    """What one series says of a satellite."""

    detector: str
    signal: str | None
    quantity: str
    alarm: Alarm | None
    tests: int
    tested_s: float
    start_s: float
    held_until_s: float
    """Until when its signals were held; -inf for never."""
    window_s: float
    notes: tuple[str, ...]

    @property
    def of(self) -> tuple[str, str | None, str]:
        """What sections of one track have in common."""
        return self.detector, self.signal, self.quantity


def share_of(config: DetectionConfig, count: int = 1) -> DetectionConfig:
    """The configuration with the part of the false alarms that ``count`` detectors may make."""
    share = count / len(set(config.detectors))
    return config.model_copy(
        update={
            "false_alarm_probability": config.false_alarm_probability * share,
            "false_alarms_per_hour": config.false_alarms_per_hour * share,
        }
    )


def judge(
    log: TrackLog, system: str, prn: int, examined: Sequence[Examined], config: DetectionConfig
) -> SatelliteVerdict:
    """The rule of this module, for one satellite."""
    alarms = first_alarms(examined)
    decisive = deciding(alarms)
    support_s, tests = _support(examined, config)
    if alarms:
        held = _held(log, system, prn)
        strong = evidence_of(decisive[0].detector) == "consistency"
        reflected = strong and reflection.explains(log, (system, prn), alarms, decisive, config)
        verdict = SPOOFED if strong and not reflected else SUSPECT
        onset_s = fused_onset(decisive, alarms)
        where = attribute(held, alarms, onset_s, config)
        action, fallback = _action(verdict, where, held, decisive)
        reason = _alarm_reason(decisive, alarms, where, onset_s)
        if reflected:
            reason += "; the peaks of all its bands changed with it: a reflection does this too"
        confidence = _confidence(decisive, examined)
    else:
        onset_s, where, confidence, fallback = None, Attribution(None, None), None, None
        verdict = CLEAN if examined and support_s >= config.min_tested_s else NO_SUPPORT
        action = "use it" if verdict == CLEAN else "not judged"
        reason = _quiet_reason(log, system, prn, examined, (support_s, tests), config)
    notes = "; ".join(_notes(log, examined, verdict))
    return SatelliteVerdict(
        prn=prn,
        verdict=verdict,
        alarms=alarms,
        reason=f"{reason}; {notes}" if notes else reason,
        system=system,
        onset_s=onset_s,
        band=where.signal,
        band_confidence=where.confidence,
        confidence=confidence,
        action=action,
        fallback=fallback,
    )


def deciding(alarms: Sequence[Alarm]) -> tuple[Alarm, ...]:
    """Those that a verdict rests on: of consistency, or all where there is none."""
    return tuple(a for a in alarms if evidence_of(a.detector) == "consistency") or tuple(alarms)


def evidence_of(detector: str) -> str:
    """'consistency' or 'quality'."""
    return detectors.find(detector).evidence


def first_alarms(examined: Sequence[Examined]) -> tuple[Alarm, ...]:
    """The first alarm of each detector, signal and quantity: it stays.

    Those of consistency come first, and among them those that name a band.
    """
    found: dict[tuple[str, str | None, str], Alarm] = {}
    for e in examined:
        if e.alarm is not None:
            found.setdefault(e.of, e.alarm)

    def rank(alarm: Alarm) -> tuple[bool, bool]:
        return evidence_of(alarm.detector) != "consistency", alarm.band is None

    return tuple(sorted(found.values(), key=rank))


def fused_onset(deciding: Sequence[Alarm], alarms: Sequence[Alarm]) -> float:
    """Median onset of all alarms that date the event before a deciding test first fired.

    One estimate of a gentle beginning may be off by seconds; of an even number, the later counts.
    """
    first_s = min(a.alarm_s for a in deciding)
    return median_high(a.onset_s for a in alarms if a.onset_s <= first_s)


def _support(examined: Sequence[Examined], config: DetectionConfig) -> tuple[float, int]:
    """Length that the best-supported series tested, in s, and tests made.

    Tests of quality count only where no test of consistency is configured.
    """
    every = all(evidence_of(name) == "quality" for name in config.detectors)
    counted = [e for e in examined if every or evidence_of(e.detector) == "consistency"]
    by_series: dict[tuple[str, str | None, str], float] = defaultdict(float)
    for e in counted:
        by_series[e.of] += e.tested_s
    return max(by_series.values(), default=0.0), sum(e.tests for e in counted)


def _confidence(deciding: Sequence[Alarm], examined: Sequence[Examined]) -> float:
    """One minus the Bonferroni bound on a false alarm in all that was tested."""
    tests = sum(e.tested_s / e.window_s for e in examined)
    log10_p = min(a.log10_p for a in deciding) + np.log10(max(tests, 1.0))
    return float(1.0 - 10.0 ** min(log10_p, 0.0))


def _action(
    verdict: str, where: Attribution, held: Sequence[str], deciding: Sequence[Alarm]
) -> tuple[str, str | None]:
    """What to do, and the signal that is left."""
    if verdict == SUSPECT:
        return "give it less weight until it is quiet again", None
    accused = {a.band for a in deciding} | {where.signal}
    clean = [signal for signal in held if signal not in accused]
    if where.both:
        return f"drop the satellite: {BOTH_CHANGED}", None
    if where.signal is None or not clean:
        return "drop the satellite", None
    return f"use {composite(clean[0])} alone", clean[0]


def _alarm_reason(
    deciding: Sequence[Alarm], alarms: Sequence[Alarm], where: Attribution, onset_s: float
) -> str:
    first = deciding[0]
    fused = replace(first, onset_s=onset_s, band=first.band or where.signal)
    parts = [alarm_reason(fused)]
    others = list(dict.fromkeys(detectors.find(a.detector).title for a in alarms if a != first))
    if others:
        parts.append(f"also: {', '.join(others)}")
    if where.both:
        parts.append(BOTH_CHANGED)
    if where.evidence:
        parts.append(f"evidence for the band: {', '.join(where.evidence)}")
    return "; ".join(parts)


def alarm_reason(alarm: Alarm) -> str:
    """An alarm and its number in words."""
    detector = detectors.find(alarm.detector)
    size = f"{alarm.statistic:+.3f} {alarm.unit} against a threshold of {alarm.threshold:.3f}"
    if alarm.detector.startswith("phase_difference"):
        if alarm.band:
            what = (
                f"the carrier of {composite(alarm.band)} left its course at {alarm.onset_s:.2f} s"
            )
        else:
            at = f"{alarm.onset_s:.2f} s"
            what = f"one carrier left the other at {at}, which of them cannot be told"
        measured = "difference rate" if alarm.unit == "Hz" else "difference"
        return f"{what}; {measured} {size} {alarm.unit}"
    of = f" of {composite(alarm.band)}" if alarm.band else ""
    if alarm.detector == second_peak.NAME:
        return f"{second_peak.CAUSE}; found by the search at {alarm.alarm_s:.2f} s: {size}"
    if cause := detectors.common_cause(alarm):
        what = f"the noise floor{of} rose for all satellites alike at {alarm.onset_s:.2f} s"
        return f"{what}, by {size}: {cause}"
    quantity = f" ({alarm.quantity})" if alarm.quantity else ""
    return f"{detector.title}{quantity}{of} changed at {alarm.onset_s:.2f} s: {size}"


def _quiet_reason(
    log: TrackLog,
    system: str,
    prn: int,
    examined: Sequence[Examined],
    support: tuple[float, int],
    config: DetectionConfig,
) -> str:
    tested_s, tests = support
    if tested_s >= config.min_tested_s and examined:
        return f"{tested_s:.1f} s tested in {tests} overlapping windows, none beyond the threshold"
    if any(e.signal is None for e in examined):
        return f"only {tested_s:.1f} s could be tested, {config.min_tested_s:g} s are needed"
    return _untested_reason(log, system, prn)


def _untested_reason(log: TrackLog, system: str, prn: int) -> str:
    held = [t.signal for t in tracks_of(log, system, prn) if (t.state >= State.TRACKING).any()]
    if not held:
        return "no signal of this satellite was held long enough to test"
    names = " and ".join(sorted({composite(signal) for signal in held}))
    return f"received on {names} only; the test compares two bands"


def _notes(log: TrackLog, examined: Sequence[Examined], verdict: str) -> Iterator[str]:
    """What the detectors note of all sections of a satellite's track, each note once.

    Where others judged, of those without support no more is said than that they had none.
    """
    by_series: dict[tuple[str, str | None, str], list[Examined]] = defaultdict(list)
    for e in examined:
        by_series[e.of].append(e)
    idle: list[str] = []
    notes: list[str] = []
    busy = {e.detector for e in examined if e.tests}
    for (detector, signal, _), es in by_series.items():
        if verdict == NO_SUPPORT or any(e.tests for e in es):
            notes += _of_series(log, signal, es)
        elif detector not in busy:
            idle.append(detectors.find(detector).title)
    yield from dict.fromkeys(notes)
    if idle:
        yield f"too little support for: {', '.join(dict.fromkeys(idle))}"


def _of_series(log: TrackLog, signal: str | None, examined: Sequence[Examined]) -> Iterator[str]:
    for e in examined:
        for note in e.notes:
            yield note if len(examined) == 1 else f"from {e.start_s:.0f} s on {note}"
    # A band was lost for good, as by a strong attack with a carrier of its own.
    until_s = max(e.held_until_s for e in examined)
    if signal is None and -np.inf < until_s < log.duration_s - examined[0].window_s:
        yield f"both bands were held together only until {until_s:.2f} of {log.duration_s:.2f} s"


def _held(log: TrackLog, system: str, prn: int) -> list[str]:
    """Signals that the satellite was received on."""
    names = {t.signal for t in tracks_of(log, system, prn)}
    for combo in combos_of(log, system, prn):
        names |= {combo.lower, combo.upper}
    return sorted(names)


def composite(signal: str) -> str:
    """Name of a signal as users know it: B1C, not its pilot."""
    return signal_spec(signal).composite
