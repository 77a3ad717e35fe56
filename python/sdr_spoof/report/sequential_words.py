"""What sequential tests found in plain words, for the HTML report and the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.dme.statistics import STATISTICS
from sdr_spoof.fusion import CLEAN, NO_SUPPORT, SPOOFED

from .aided_words import LEVELS
from .page import listed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sdr_spoof.aiding.dme.config import SequentialConfig
    from sdr_spoof.aiding.dme.judge import Judgement, Tested
    from sdr_spoof.decision import Decision

HEADLINES = {
    SPOOFED: "Spoofing detected",
    CLEAN: "No spoofing found",
    NO_SUPPORT: "Not enough support for a verdict",
}
TITLES = {
    "difference-clock-free": "Satellites against the INS",
    "parity-by-satellite": "Satellites against each other",
    "dme-difference": "DME against the INS",
}
_SURE = 1e-6
"""Nobody knows the tails of noise further."""


def verdict(found: Judgement) -> str:
    """Spoofed, clean, or not enough support."""
    if found.alarm_s is not None:
        return SPOOFED
    return CLEAN if any(not t.note for t in found.tested) else NO_SUPPORT


def level(found: Judgement) -> str:
    """'spoofed', 'clean' or 'unsupported', for colours."""
    return LEVELS[verdict(found)]


def headline(found: Judgement) -> str:
    """The answer in a few words."""
    return HEADLINES[verdict(found)]


def alarms(found: Judgement) -> list[tuple[Decision, Tested]]:
    """Channels that alarmed, the first one first."""
    made = [(t.decided, t) for t in found.tested if t.decided is not None]
    return sorted(made, key=lambda a: (a[0].alarm_s, a[0].log10_p))


def sentences(found: Judgement) -> Iterator[str]:
    """Which satellites, since when."""
    if found.alarm_s is None:
        return
    decided, _ = alarms(found)[0]
    when = f"since {decided.onset_s:.1f} s (alarm at {found.alarm_s:.1f} s)"
    yield f"{_who(found)}, {when}."
    if found.captured:
        if found.differences.learnt:
            yield "DME contradicts the place that INS and satellites give together."
        else:
            yield "DME contradicts the INS: it follows the spoofer and cannot be trusted."
    if found.spoofed and found.isolation is not None:
        if not found.isolation.unique:
            yield "Another set of as many satellites explains it nearly as well."
        if found.isolation.after_m is None:
            yield "It may be all of them: too few are left for a place."


def _who(found: Judgement) -> str:
    isolation = found.isolation
    if found.spoofed:
        return listed(found.spoofed)
    if isolation is None or isolation.satellites is None:
        return "Which satellites cannot be told, no set of them explains it"
    if found.captured:
        alone = found.differences.learnt
        return "All satellites alike" if alone else "All satellites alike, and the INS with them"
    return "Which satellites cannot be told, they soon agreed with one another"


def why(found: Judgement) -> str:
    """The first alarm with its number, and how many others there are."""
    if found.alarm_s is None:
        if verdict(found) == CLEAN:
            return "no test has alarmed"
        return "no test could judge its samples"
    (decided, tested), *others = alarms(found)
    more = f"; {len(others)} more of the tests alarmed" if others else ""
    return f"{TITLES[tested.test]}, {tested.channel}: {_size(decided)}{more}"


def alarm_lines(found: Judgement) -> Iterator[str]:
    """Each alarm, a line."""
    for decided, tested in alarms(found):
        at = f"{decided.alarm_s:.1f} s"
        yield f"{tested.test}, {tested.channel}: {at}, {_size(decided)}"


def sureness(found: Judgement) -> str:
    """In words, how likely noise alone does this anywhere in the flight."""
    samples = sum(t.series.time_s.size for t in found.tested if not t.note)
    rarest = min(decided.log10_p for decided, _ in alarms(found))
    return by_noise(min(samples * 10.0**rarest, 1.0))


def by_noise(probability: float) -> str:
    """How likely noise alone does it anywhere in a recording."""
    if probability <= _SURE:
        return "noise alone does this with a probability below one in a million"
    return (
        f"noise alone does this anywhere in the recording with a probability of {probability:.2g}"
    )


def action(found: Judgement) -> str:
    """What to do."""
    isolation = found.isolation
    if found.spoofed and isolation is not None and isolation.unique:
        if isolation.after_m is not None:
            return f"leave {listed(found.spoofed)} out; the place found with the others is good"
        return f"leave {listed(found.spoofed)} out; the others give no place, the INS alone goes on"
    if found.captured:
        return "trust neither GNSS nor what it makes of the INS; DME tells the place"
    return "trust no satellite while this lasts; the INS alone goes on, less and less exactly"


def place(found: Judgement) -> str | None:
    """How far the fix is from where the INS says, and without those that are left out."""
    isolation = found.isolation
    if isolation is None or isolation.before_m is None:
        return None
    text = f"with all satellites {_size_m(isolation.before_m)} from where the INS says"
    if found.spoofed and isolation.after_m is not None:
        return f"{text}, without {listed(found.spoofed)} {_size_m(isolation.after_m)}"
    return text


def drift(found: Judgement, config: SequentialConfig) -> str:
    """How far a free INS is expected to be off at the end."""
    off_m = np.linalg.norm(found.differences.error_m[-1])
    sigma_m = np.sqrt(np.trace(found.differences.error_m2[-1]))
    return (
        f"a free one of grade “{config.ins_grade}”, aligned {config.ins_aligned_s:g} s before the "
        f"first epoch; expected to be off by {off_m:.0f} m (sigma {sigma_m:.1f} m) at the end"
    )


def tested(found: Judgement) -> str:
    """How much could be tested, and by what."""
    judged = [t for t in found.tested if not t.note]
    if not judged:
        return f"none of {len(found.tested)} channels could be judged"
    names = [STATISTICS[name].tests for name in dict.fromkeys(t.test for t in judged)]
    span_s = float(np.ptp(found.differences.time_s))
    how = f"{len(judged)} of {len(found.tested)} channels over {span_s:.0f} s"
    return f"{how}: {'; '.join(names)}"


def _size(decided: Decision) -> str:
    return f"{decided.statistic:.1f} over {decided.threshold:.1f}"


def _size_m(offset_m: np.ndarray) -> str:
    return f"{float(np.linalg.norm(offset_m)):.1f} m"
