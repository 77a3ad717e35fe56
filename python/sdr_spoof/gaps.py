"""Samples that are missing from a recording, told by signals whose code periods are miscounted.

A count of code periods is right up to the last look of the tracker that found it so, and wrong
when it says so; in between is the gap. All signals come from the same samples: where two satellites
break together, the counts of all do, also of those whose codes cannot show it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .signals import satellite_name, signal_spec

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from .records import SignalTrack, TrackLog

Span = tuple[float, float]
"""From and until, s of the recording."""

FEWEST = 2
"""So many satellites break together where samples are missing."""


@dataclass(frozen=True)
class CountBreak:
    """The code periods of a signal that went on were miscounted: samples are missing."""

    signal: str
    prn: int
    from_s: float
    """When the count was right for the last time."""
    until_s: float
    """When it was found to be wrong, and symbols and secondary code were searched for anew."""


@dataclass(frozen=True)
class Gap:
    """Samples are missing somewhere between two instants."""

    from_s: float
    until_s: float
    satellites: tuple[str, ...]
    """Whose code periods were miscounted."""

    @property
    def span(self) -> Span:
        """The two instants."""
        return self.from_s, self.until_s


def gaps_of(log: TrackLog) -> list[Gap]:
    """Gaps of a recording, in order."""
    gaps: list[Gap] = []
    rest = sorted(log.breaks, key=lambda b: b.until_s)
    while rest:
        until_s = rest[0].until_s
        together = [b for b in rest if b.from_s < until_s]
        rest = [b for b in rest if b.from_s >= until_s]
        names = tuple(sorted({_name(b) for b in together}))
        if len(names) >= FEWEST:
            gaps.append(Gap(max(b.from_s for b in together), until_s, names))
    return gaps


def uncounted(log: TrackLog, track: SignalTrack) -> list[Span]:
    """Spans of a track within which its count of code periods ended: no value in them holds."""
    system = signal_spec(track.signal).system
    own = [
        (b.from_s, b.until_s)
        for b in log.breaks
        if (b.prn, signal_spec(b.signal).system) == (track.prn, system)
    ]
    return joined([*own, *(g.span for g in gaps_of(log))])


def counted(
    time_s: NDArray[np.float64], half_s: NDArray[np.float64], spans: Sequence[Span]
) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Which rows lie outside of spans, and how many spans lie before each."""
    before = np.zeros(time_s.size, np.intp)
    outside = np.ones(time_s.size, np.bool_)
    for begin, end in spans:
        before += time_s > begin
        outside &= (time_s + half_s <= begin) | (time_s - half_s >= end)
    return outside, before


def sentences(gaps: Iterable[Gap]) -> list[str]:
    """What is to be said of gaps."""
    return [
        f"samples are missing from the recording between {g.from_s:.2f} and {g.until_s:.2f} s: "
        f"the code periods of {', '.join(g.satellites)} were out of step; no time holds from "
        "there on until it is received again"
        for g in gaps
    ]


def joined(spans: list[Span]) -> list[Span]:
    """The same in order, those that overlap as one."""
    found: list[Span] = []
    for begin, end in sorted(spans):
        if found and begin <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], end)
        else:
            found.append((begin, end))
    return found


def _name(one: CountBreak) -> str:
    return satellite_name(signal_spec(one.signal).system, one.prn)
