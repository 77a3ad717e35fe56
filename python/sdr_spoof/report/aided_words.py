"""The verdict of aided navigation in plain words, for the HTML report and the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.fusion import CLEAN, NO_SUPPORT, SPOOFED, SUSPECT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sdr_spoof.aided.judge import AidedVerdict

LEVELS = {SPOOFED: "spoofed", SUSPECT: "suspect", CLEAN: "clean", NO_SUPPORT: "unsupported"}
_HEADLINES = {
    SPOOFED: "Spoofing detected",
    SUSPECT: "Suspicious signals",
    CLEAN: "No spoofing found",
    NO_SUPPORT: "Not enough support for a verdict",
}
HARMLESS_M = 10.0
"""A place that is off by less says little."""
_SURE = 1e-6
"""Nobody knows the tails of noise further."""


def headline(verdict: AidedVerdict) -> str:
    """The answer in a few words."""
    if verdict.verdict == CLEAN and verdict.heeded:
        return "No spoofing beside what the receiver itself has found"
    return _HEADLINES[verdict.verdict]


def level(verdict: AidedVerdict) -> str:
    """'spoofed', 'suspect', 'clean' or 'unsupported', for colours."""
    return LEVELS[verdict.verdict]


def sentences(verdict: AidedVerdict) -> Iterator[str]:
    """Since when, which satellites, how bad."""
    yield from _found(verdict)
    others = [name for name in verdict.heeded if name not in verdict.satellites]
    if others:
        yield f"Spoofed by the receiver's own detectors, and not used: {', '.join(others)}."


def _found(verdict: AidedVerdict) -> Iterator[str]:
    if verdict.onset_s is None:
        return
    at = f"since {verdict.onset_s:.1f} s (alarm at {verdict.alarm_s:.1f} s)"
    if verdict.everybody and not verdict.satellites:
        yield f"All satellites, or more than can be told apart, {at}."
    elif verdict.satellites:
        yield f"{', '.join(verdict.satellites)}, {at}."
    else:
        yield f"Which satellites cannot be told; {at}."
    if verdict.severity_m is not None:
        yield f"Severity: {severity(verdict)}."


def severity(verdict: AidedVerdict) -> str:
    """How far GNSS alone was led away."""
    away = verdict.severity_m or 0.0
    if away < HARMLESS_M:
        return f"so far harmless to the place, GNSS alone is off by {away:.0f} m at most"
    return f"GNSS alone was led {away:.0f} m away from the place found with the INS"


def sureness(verdict: AidedVerdict) -> str:
    """In words, how likely noise alone explains it."""
    if verdict.confidence is None:
        return "not known: the test that alarmed states no law"
    p = 1.0 - verdict.confidence
    if p <= _SURE:
        return "noise alone does this with a probability below one in a million"
    return f"noise alone does this anywhere in the recording with a probability of {p:.2g}"


def action(verdict: AidedVerdict) -> str:
    """What to do."""
    if verdict.verdict == SUSPECT and verdict.doubt:
        return "mend what does not fit, and judge again; until then trust neither"
    if verdict.verdict == SUSPECT:
        return "use the aided place, and watch it"
    if verdict.everybody or not verdict.satellites:
        return (
            "use no GNSS while this lasts; the INS alone goes on, less and less exactly, as its "
            "protection level says"
        )
    names = sorted({*verdict.satellites, *verdict.heeded})
    return f"leave {', '.join(names)} out; the place found with the others is good"


def tested(verdict: AidedVerdict) -> str:
    """How much could be tested."""
    return (
        f"{verdict.tested_s:.0f} s of pseudoranges, rates and carrier phases against what the "
        "inertial sensors say of the motion"
    )
