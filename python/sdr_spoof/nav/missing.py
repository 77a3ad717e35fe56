"""Missing samples, told by frames: more time passes between two of a satellite than samples do.

It does not matter what the tracker made of it. A satellite's travel time, and the receiver's clock,
change by some 1e-5 of the time that passes; two satellites that miss the same are believed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from ..signals import satellite_name
from .steps import LOSING_S

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from ..gaps import Span
    from .records import Frame
    from .steps import Reach

LEAST_S, DRIFT = 0.5e-3, 2e-5
"""What is missing is more than this, and more than this share of what passes."""
SATELLITES = 2
NEAR_S = 0.7
"""Spans of one gap may miss each other by a word, at worst."""
HEAD = 0.2
"""Share of a subframe that tells its time."""


@dataclass(frozen=True)
class Missing:
    """Samples missing somewhere between two instants."""

    from_s: float
    until_s: float
    missing_s: float
    satellites: frozenset[str]

    @property
    def span(self) -> Span:
        """The two instants."""
        return self.from_s, self.until_s


def missing(frames: Iterable[Sequence[Frame]], reach: Callable[[Frame], Reach]) -> list[Missing]:
    """What is missing by the frames of several signals; those of each in order of time."""
    together: list[list[Missing]] = []
    told = [m for of_signal in frames for m in _told(of_signal, reach)]
    for one in sorted(told, key=lambda m: m.until_s):
        same = [group for group in together if _same(one, group[0])]
        if same:
            same[0].append(one)
        else:
            together.append([one])
    found = (_joined(group) for group in together)
    return [m for m in found if len(m.satellites) >= SATELLITES]


def _told(frames: Sequence[Frame], reach: Callable[[Frame], Reach]) -> list[Missing]:
    told = []
    for a, b in pairwise(frames):
        passed_s, sampled_s = b.transmitted - a.transmitted, b.time_s - a.time_s
        if abs(passed_s - sampled_s) > LEAST_S + DRIFT * abs(passed_s):
            name = frozenset({satellite_name(a.system, a.prn)})
            span = between(a, reach(a), b, reach(b))
            told.append(Missing(*span, passed_s - sampled_s, name))
    return told


def between(a: Frame, after: Reach, b: Frame, before: Reach) -> Span:
    """Within which span of receiver time samples are missing between two frames.

    Not later than the first word that fails in step with the one; not earlier than the last that
    fails in step with the other.
    """
    # Beyond its head a frame may have gone on with blanks, which hold wherever they begin.
    from_s = min(a.time_s + HEAD * a.duration_s, after.run_until_s)
    until_s = max(b.time_s, before.run_from_s)
    if after.failed_after_s is not None:
        until_s = min(until_s, after.failed_after_s)
    else:
        from_s = max(from_s, after.held_until_s)
    if before.failed_before_s is not None:
        from_s = max(from_s, before.failed_before_s)
    else:
        until_s = min(until_s, before.held_from_s)
    return min(from_s, until_s), until_s


def _same(a: Missing, b: Missing) -> bool:
    return abs(a.missing_s - b.missing_s) < LEAST_S and (
        max(a.from_s, b.from_s) <= min(a.until_s, b.until_s) + NEAR_S
    )


def _joined(group: Sequence[Missing]) -> Missing:
    """What several satellites say: the narrowest span that two of them support."""
    from_s = sorted(m.from_s for m in group)[-SATELLITES:][0]
    until_s = sorted(m.until_s for m in group)[:SATELLITES][-1]
    names = frozenset().union(*(m.satellites for m in group))
    return Missing(min(from_s, until_s), until_s, group[0].missing_s, names)


def out_of_step(ends: Iterable[tuple[str, Reach, Reach]]) -> list[Span]:
    """Where samples are missing by words that fail before the first frame, or after the last one,
    of two satellites: of each its name, and how far it is in step with these frames."""
    spans = []
    for name, first, last in ends:
        if first.failed_before_s is not None and math.isfinite(first.from_s):
            spans.append((name, (first.failed_before_s, first.from_s)))
        if last.failed_after_s is not None and math.isfinite(last.until_s):
            spans.append((name, (last.until_s, last.failed_after_s)))
    found: list[Span] = []
    for name, span in sorted(spans, key=lambda s: s[1][1]):
        others = [s for n, s in spans if n != name and overlap(s, span)]
        if others and not any(overlap(span, f) for f in found):
            # Neither the latest beginning nor the earliest end is taken at its word.
            begins = sorted([span[0], *(s[0] for s in others)])
            found.append((begins[-SATELLITES], min(s[1] for s in others)))
    return found


def overlap(a: Span, b: Span) -> bool:
    """Whether two spans have anything in common."""
    return a[0] < b[1] and b[0] < a[1]


def touch(a: Span, b: Span) -> bool:
    """Whether two spans have at least an instant in common, give or take a millisecond."""
    return a[0] <= b[1] + 1e-3 and b[0] <= a[1] + 1e-3


def outages(stretches: Iterable[Span], end_s: float) -> list[Span]:
    """Where all signals were lost though the recording goes on, up to ``end_s``: the last moments
    of what was lost, within which samples may be missing."""
    found: list[Span] = []
    alive_s = math.inf
    for begin, until in sorted(stretches):
        if begin > alive_s:
            found.append((alive_s - LOSING_S, alive_s))
        alive_s = until if math.isinf(alive_s) else max(alive_s, until)
    if alive_s < end_s - LOSING_S:
        found.append((alive_s - LOSING_S, alive_s))
    return found


def sentences(found: Iterable[Missing]) -> list[str]:
    """What is to be said of them."""
    return [
        f"{m.missing_s:+.3f} s of samples are missing between {m.from_s:.1f} and {m.until_s:.1f} s "
        f"of the recording, by the messages of {len(m.satellites)} satellites"
        for m in found
    ]
