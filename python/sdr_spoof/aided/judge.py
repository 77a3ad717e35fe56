"""From what the filter and the tests of rates say to one verdict. The rule, in order:

1. **spoofed**: the filter has left satellites out, or a test of rates has alarmed. Unless the
   filter has taken all its alarms back, since everything agreed again soon after, and no test of
   rates alarmed: then it is
2. **suspect**. So is an alarm that names nobody while IMU and GNSS have not fitted from the
   beginning (:mod:`.agreement`): a wrong lever arm, for instance, looks like spoofing of all.
   Where some satellites are named, the others agree with the IMU, which so is right.
3. **clean**: no alarm, and something could be tested for ``min_tested_s``.
4. **not enough support**: anything else, such as an INS that is too old to be a witness.

Alarms latch. The onset is the median of what the alarms say that date it before the first of them,
since one estimate may be off by seconds; the severity is how far GNSS alone was
led away from the aided place while satellites were not believed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from statistics import median_high
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.fusion import CLEAN, NO_SUPPORT, SPOOFED, SUSPECT

from .records import Guard, Use, stretches

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .records import AidedTrack, Monitor

MIN_TESTED_S = 10.0
"""Less is not enough support for 'clean'."""


@dataclass(frozen=True)
class AidedVerdict:
    """What aiding says of a recording."""

    verdict: str
    """'spoofed', 'suspect', 'clean' or 'not enough support'."""
    reason: str
    """In a sentence."""
    onset_s: float | None = None
    """Since when."""
    alarm_s: float | None = None
    """When the first alarm was raised."""
    satellites: tuple[str, ...] = ()
    """RINEX names of those left out after the alarm; empty where nobody can be named."""
    everybody: bool = False
    """Whether all satellites were disbelieved at once."""
    severity_m: float | None = None
    """Largest distance of GNSS alone from the aided place since the onset."""
    confidence: float | None = None
    """One minus the probability that noise alone does it anywhere in what was tested."""
    tested_s: float = 0.0
    notes: tuple[str, ...] = ()
    """What could not be tested, and why."""
    limits: str = ""
    """In words, what the tests cannot see."""
    heeded: tuple[str, ...] = ()
    """RINEX names of satellites left out because the receiver's own detectors call them spoofed."""
    doubt: str = ""
    """What else the alarms may come from, and is to be mended first; in a sentence."""


def judge(
    track: AidedTrack | None,
    monitors: Sequence[Monitor],
    notes: Sequence[str] = (),
    limits: str = "",
    tests: float = 1.0,
    min_tested_s: float = MIN_TESTED_S,
    named: Sequence[str] = (),
) -> AidedVerdict:
    """The rule of this module.

    Args:
        track: of the filter; None where there is none.
        monitors: statistics with their alarms, of the filter and of rates.
        notes: what could not be tested.
        limits: what the tests cannot see.
        tests: independent tests made, by which the probability of a false alarm is multiplied.
        min_tested_s: less is not enough support for 'clean'.
        named: satellites that the filter has named, if only for an instant.
    """
    alarmed = [m for m in monitors if m.alarm_s is not None]
    tested_s = max((_tested_s(m) for m in monitors), default=0.0)
    quiet = AidedVerdict(
        CLEAN,
        "",
        tested_s=tested_s,
        notes=tuple(notes),
        limits=limits,
        heeded=_heeded(track),
    )
    spans = _disbelieved(track)
    if not alarmed and not spans:
        enough = tested_s >= min_tested_s
        why = f"{tested_s:.0f} s tested, nothing beyond its threshold"
        if quiet.heeded:
            why += f" without {', '.join(quiet.heeded)}, which the receiver's own detectors name"
        if not enough:
            why = f"only {tested_s:.0f} s could be tested, {min_tested_s:g} s are needed"
            why += f": {notes[0]}" if notes else ""
        return replace(quiet, verdict=CLEAN if enough else NO_SUPPORT, reason=why)
    alarm_s = min([m.alarm_s for m in alarmed if m.alarm_s is not None] + [a for a, _ in spans])
    onsets = [m.onset_s for m in alarmed if m.onset_s is not None]
    before = [o for o in onsets if o <= alarm_s]
    onset_s = median_high(before) if before else alarm_s
    names, everybody = _left_out(track)
    names = tuple(sorted({*names, *named}))
    excluded = bool(names) or everybody or any(m.decides for m in alarmed)
    verdict = SPOOFED if excluded else SUSPECT
    return replace(
        quiet,
        verdict=verdict,
        reason=_reason(alarmed, names, everybody, verdict, quiet.heeded),
        onset_s=onset_s,
        alarm_s=alarm_s,
        satellites=names,
        everybody=everybody,
        severity_m=_severity_m(track, onset_s),
        confidence=_confidence(alarmed, tests),
    )


def doubted(verdict: AidedVerdict, why: str) -> AidedVerdict:
    """The same, where something else than spoofing may be behind the alarms."""
    known = replace(verdict, doubt=why, notes=(why, *verdict.notes))
    if verdict.verdict not in (SPOOFED, SUSPECT) or verdict.satellites:
        return known
    return replace(known, verdict=SUSPECT, reason=f"{verdict.reason}; but {why}, and judge again")


def _tested_s(monitor: Monitor) -> float:
    """Length over which there was a test."""
    there = np.isfinite(monitor.value) & np.isfinite(monitor.threshold)
    return sum(b - a for a, b in stretches(monitor.time_s, there))


def _disbelieved(track: AidedTrack | None) -> tuple[tuple[float, float], ...]:
    if track is None:
        return ()
    return stretches(track.time_s, track.guard >= Guard.DECIDING)


def _left_out(track: AidedTrack | None) -> tuple[tuple[str, ...], bool]:
    """Satellites named, and whether all were left out together after a decision."""
    if track is None:
        return (), False
    # At the epoch of the decision itself none is used yet.
    partial = (track.guard == Guard.PARTIAL) & (track.use == Use.USED).any(axis=1)
    out = (track.use == Use.EXCLUDED) & partial[:, None]
    names = tuple(n for n, hit in zip(track.satellites, out.any(axis=0), strict=True) if hit)
    return names, bool((track.guard == Guard.COASTING).any())


def _heeded(track: AidedTrack | None) -> tuple[str, ...]:
    """Satellites that were not used on the word of the receiver's own detectors."""
    if track is None:
        return ()
    named = (track.use == Use.NAMED).any(axis=0)
    return tuple(n for n, hit in zip(track.satellites, named, strict=True) if hit)


def _severity_m(track: AidedTrack | None, onset_s: float) -> float | None:
    if track is None:
        return None
    away = np.linalg.norm(track.alone_m - track.position_m, axis=1)[track.time_s >= onset_s]
    away = away[np.isfinite(away)]
    return float(away.max()) if away.size else None


def _confidence(alarmed: Sequence[Monitor], tests: float) -> float | None:
    if not alarmed:
        return None
    log10_p = min(m.log10_p for m in alarmed) + np.log10(max(tests, 1.0))
    return float(1.0 - 10.0 ** min(log10_p, 0.0))


def _reason(
    alarmed: Sequence[Monitor],
    names: tuple[str, ...],
    everybody: bool,
    verdict: str,
    heeded: tuple[str, ...],
) -> str:
    parts = []
    if alarmed:
        first = min(alarmed, key=lambda m: m.alarm_s or 0.0)
        parts.append(f"{first.name} alarmed first, at {first.alarm_s:.1f} s")
        others = list(dict.fromkeys(m.name for m in alarmed if m is not first))
        if others:
            parts.append(f"also {', '.join(others)}")
    if names:
        others = [name for name in heeded if name not in names]
        known = f", and without {', '.join(others)}, which the receiver itself names,"
        without = f"without {', '.join(names)}{known if others else ''}"
        parts.append(f"{without} the others agree with the INS")
    if everybody:
        parts.append("no small set of satellites explains it, so that none was believed")
    if verdict == SUSPECT:
        parts.append("everything agreed again soon after, and the alarm was taken back")
    return "; ".join(parts)
