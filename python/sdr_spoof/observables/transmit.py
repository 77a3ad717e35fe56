"""When what is received was sent: spans of a run in which one anchor tells the time.

A code counter and the satellite's clock differ by a constant, the counter's *origin*: the transmit
time of code phase 0. An anchor of the message gives it. Where a signal has none of its own, it
follows from another signal of the satellite, since all code periods begin at whole multiples of
themselves: the origin is the multiple that lies nearest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.time import GnssTime

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sdr_spoof.nav.records import Anchor

    from .runs import Run

SAME_S = 1e-6
"""Origins of one counter that differ by more contradict each other."""
NEAR_PERIOD = 0.2
"""An origin told by another signal must lie this near, in code periods, to a whole period."""


@dataclass(frozen=True)
class Span:
    """Part of a run of one satellite's signal whose transmit time is known."""

    prn: int
    index: int
    """Of the run among those of its track."""
    run: Run
    """The run, or every n-th row of it."""
    from_s: float
    """Sample time."""
    until_s: float
    origin: GnssTime
    """Transmit time of code phase 0, by the satellite's clock."""

    def ahead_s(self, sample_s: float) -> float:
        """Transmit time minus ``origin`` and sample time, at a sample time within the run."""
        return float(np.interp(sample_s, self.run.time_s, self.run.code_s))


def spans_of(prn: int, runs: Sequence[Run], anchors: Iterable[Anchor]) -> list[Span]:
    """Spans of a signal's runs that its own anchors tell the time of, without contradictions."""
    spans: list[Span] = []
    mine = sorted(anchors, key=lambda a: (a.from_s, a.until_s))
    for index, run in enumerate(runs):
        first, last = float(run.time_s[0]), float(run.time_s[-1])
        told = [a for a in mine if a.from_s <= last and a.until_s >= first]
        for anchor in told:
            origin = anchor.transmitted + -anchor.code_phase_chips / run.spec.chip_rate_hz
            bounds = max(first, anchor.from_s), min(last, anchor.until_s)
            _insert(spans, Span(prn, index, run, *bounds, origin))
    return [s for s in spans if s.until_s > s.from_s]


def _insert(spans: list[Span], new: Span) -> None:
    """Add a span; where it contradicts the one before, neither holds."""
    if spans and spans[-1].index == new.index and new.from_s <= spans[-1].until_s:
        old = spans.pop()
        if abs(old.origin - new.origin) < SAME_S:
            spans.append(replace(old, until_s=max(old.until_s, new.until_s)))
            return
        spans.append(replace(old, until_s=new.from_s))
        new = replace(new, from_s=old.until_s)
    spans.append(new)


def told_by_others(prn: int, runs: Sequence[Run], others: Sequence[Span]) -> list[Span]:
    """Spans of a signal's runs whose time another signal of the satellite tells.

    They reach over the whole run: what was sent when another signal was not yet there is known too.
    """
    found = []
    for index, run in enumerate(runs):
        for other in others:
            first = max(float(run.time_s[0]), other.from_s)
            last = min(float(run.time_s[-1]), other.until_s)
            if last <= first:
                continue
            origin = _whole_period(run, other, 0.5 * (first + last))
            if origin is not None:
                bounds = float(run.time_s[0]), float(run.time_s[-1])
                found.append(Span(prn, index, run, *bounds, origin))
                break
    return found


def _whole_period(run: Run, other: Span, sample_s: float) -> GnssTime | None:
    """Origin of a run's counter: the whole code period nearest to what the other signal tells."""
    code_s = float(np.interp(sample_s, run.time_s, run.code_s))
    near = other.origin + (other.ahead_s(sample_s) - code_s)
    period_s = run.spec.period_s
    periods = near.fraction / period_s
    if abs(periods - round(periods)) > NEAR_PERIOD:
        return None
    return GnssTime(near.seconds) + round(periods) * period_s


def delay_offset_s(origin: GnssTime, time: GnssTime, sample_s: float) -> float:
    """Of a receiver clock that shows ``time`` at ``sample_s``: delay = this - ``code_s``."""
    return math.fsum((time.seconds - origin.seconds, time.fraction, -origin.fraction, -sample_s))
