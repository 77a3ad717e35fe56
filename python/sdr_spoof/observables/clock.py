"""The receiver's clock: what time, in GPST, it is at a sample.

Nothing tells a receiver the time but the signals themselves. Its clock is set once, from the
transmit times, to a few tens of ms; a fix then says how far off it is. Where samples are missing
from the recording, it must be set anew: it is a list of pieces, one for each stretch of unbroken
tracks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import median_low
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.time import GnssTime

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .transmit import Span

FIRST_DELAY_S = 0.070
"""Taken for the delay of the nearest satellite when the clock is set: that of one in a medium
orbit near the zenith (BDS 71 ms, GPS 67 ms)."""
TOGETHER_S = 0.1
"""Satellites whose transmit times lie farther than this from the median do not set the clock: no
two satellites in medium or geosynchronous orbits differ by more."""
PLAUSIBLE_S = (0.0, 0.25)
"""Delays outside are not those of a satellite, even with a clock that was set to 0.07 s."""


@dataclass(frozen=True)
class ClockPiece:
    """Receiver time from a sample on: ``time + (sample_time_s - sample_s) * (1 + rate)``."""

    sample_s: float
    """From this sample on, s since the first one of the recording."""
    time: GnssTime
    """Receiver time at that sample."""
    rate: float = 0.0
    """Receiver time gains so many seconds per second of samples."""

    def since(self, reference: GnssTime, sample_time_s: float) -> float:
        """Receiver time at a sample, s since ``reference``."""
        elapsed_s = sample_time_s - self.sample_s
        return math.fsum(
            (
                self.time.seconds - reference.seconds,
                self.time.fraction,
                -reference.fraction,
                elapsed_s,
                elapsed_s * self.rate,
            )
        )

    def at(self, sample_time_s: float) -> GnssTime:
        """Receiver time at a sample."""
        return self.time + (sample_time_s - self.sample_s) * (1.0 + self.rate)

    def samples_at(self, reference: GnssTime, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sample times at receiver times; ``time_s`` counts from ``reference``."""
        offset_s = (reference.seconds - self.time.seconds) + (
            reference.fraction - self.time.fraction
        )
        return self.sample_s + (time_s + offset_s) / (1.0 + self.rate)

    def corrected(self, sample_s: float, bias_s: float, drift: float) -> ClockPiece:
        """The same clock less what a fix at a sample found it to be fast, and to gain."""
        true = self.at(sample_s) + (-bias_s)
        rate = (1.0 + self.rate) * (1.0 - drift) - 1.0
        return ClockPiece(self.sample_s, true + (self.sample_s - sample_s) * (1.0 + rate), rate)


@dataclass(frozen=True)
class ReceiverClock:
    """Pieces in order; each holds until the next one begins, the first one also before."""

    pieces: tuple[ClockPiece, ...]

    def spans(self, end_s: float) -> list[tuple[float, float, ClockPiece]]:
        """(from, until, piece) in sample time, up to ``end_s``."""
        starts = [0.0, *(p.sample_s for p in self.pieces[1:]), end_s]
        return [(starts[i], starts[i + 1], p) for i, p in enumerate(self.pieces)]


def set_clock(spans: Sequence[Span]) -> ReceiverClock:
    """Set the clock by the transmit times, and anew after a gap where it no longer fits."""
    pieces: list[ClockPiece] = []
    for group in _stretches(spans):
        start_s = min(s.from_s for s in group)
        if pieces and all(plausible(s, pieces[-1]) for s in group):
            continue
        first = group[0].origin
        ahead = [(s.origin - first) + s.ahead_s(s.from_s) for s in group]
        middle = median_low(ahead)  # one of them, even where they are of two minds
        nearest = float(max(a for a in ahead if abs(a - middle) <= TOGETHER_S))
        pieces.append(ClockPiece(start_s, first + nearest + (start_s + FIRST_DELAY_S)))
    return ReceiverClock(tuple(pieces))


def plausible(span: Span, piece: ClockPiece) -> bool:
    """Whether a satellite may be as far away as this clock has it."""
    delay_s = piece.since(span.origin, span.from_s) - span.from_s - span.ahead_s(span.from_s)
    return PLAUSIBLE_S[0] < delay_s < PLAUSIBLE_S[1]


def _stretches(spans: Sequence[Span]) -> list[list[Span]]:
    """Spans in order of time, gathered wherever one begins before all others have ended."""
    groups: list[list[Span]] = []
    until_s = -math.inf
    for span in sorted(spans, key=lambda s: s.from_s):
        if span.from_s > until_s:
            groups.append([])
        groups[-1].append(span)
        until_s = max(until_s, span.until_s)
    return groups
