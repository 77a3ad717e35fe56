"""Parts of a recording without a gap, and the code phases at an instant of one.

Without messages nothing says what is missing at a gap: each part has a time of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.gaps import gaps_of, joined, uncounted
from sdr_spoof.nav.missing import outages
from sdr_spoof.nav.symbols import stretches_of
from sdr_spoof.observables.runs import runs_of
from sdr_spoof.phase_jumps import phase_jumps_of
from sdr_spoof.pvt import CodePhase
from sdr_spoof.signals import LIGHT_M_S

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.gaps import Span
    from sdr_spoof.observables.runs import Run
    from sdr_spoof.records import SignalTrack, TrackLog

SETTLING_S = 1.0
"""The code loop of 1 Hz has settled after this, to 2 % of where it began."""


@dataclass(frozen=True)
class Going:
    """An unbroken run of a signal within one part of the recording."""

    track: SignalTrack
    run: Run
    """Some of its rows."""

    @property
    def span(self) -> Span:
        """Its first and last instant."""
        return float(self.run.time_s[0]), float(self.run.time_s[-1])


def pieces_of(log: TrackLog) -> list[Span]:
    """Between all instants at which samples may be missing."""
    alive = [s for t in log.signals for s in stretches_of(t, uncounted(log, t))]
    lost = outages([(s.from_s, s.until_s) for s in alive], log.duration_s)
    gaps = [*(g.span for g in gaps_of(log)), *(j.span for j in phase_jumps_of(log)), *lost]
    pieces, begin_s = [], 0.0
    for from_s, until_s in joined(gaps):
        pieces.append((begin_s, from_s))
        begin_s = until_s
    return [p for p in (*pieces, (begin_s, log.duration_s)) if p[1] > p[0]]


def beyond(log: TrackLog, track: SignalTrack, piece: Span) -> list[Span]:
    """Where a track says nothing of a part of the recording."""
    return [*uncounted(log, track), (-math.inf, piece[0]), (piece[1], math.inf)]


def going(log: TrackLog, piece: Span) -> list[Going]:
    """The runs of all signals in a part of a recording."""
    return [
        Going(track, run.outline())
        for track in log.signals
        for run in runs_of(track, beyond(log, track, piece))
    ]


def instants(runs: Sequence[Going]) -> list[float]:
    """Instants at which most of the runs go on together, the best first: in the middle of the
    first time that they do, at its end, at its beginning."""
    bounds = [r.span for r in runs]
    bounds = [b for b in bounds if b[1] - b[0] > SETTLING_S] or bounds
    settled = [(begin + min(SETTLING_S, 0.5 * (end - begin)), end) for begin, end in bounds]

    def together(at_s: float) -> list[Span]:
        return [b for b in settled if b[0] <= at_s <= b[1]]

    best_s = max((begin for begin, _ in settled), key=lambda at_s: (len(together(at_s)), -at_s))
    end_s = min(end for _, end in together(best_s))
    return [0.5 * (best_s + end_s), end_s, best_s]


def phases_at(runs: Sequence[Going], at_s: float) -> list[CodePhase]:
    """Code phases of all that goes on at a sample time."""
    return [_phase(r, at_s) for r in runs if r.span[0] <= at_s <= r.span[1]]


def _phase(one: Going, at_s: float) -> CodePhase:
    run, spec = one.run, one.run.spec
    code_s = float(np.interp(at_s, run.time_s, run.code_s)) + at_s
    doppler_hz = -float(np.polyfit(run.time_s[:2], run.phase_cycles[:2], 1)[0])
    return CodePhase(
        system=spec.system,
        prn=one.track.prn,
        signal=one.track.signal,
        delay_s=-code_s % spec.period_s / (1.0 + doppler_hz / spec.carrier_hz),
        cn0_dbhz=float(np.interp(at_s, run.time_s, run.cn0_dbhz)),
        doppler_hz=doppler_hz,
        unsettled_m=LIGHT_M_S * float(np.interp(at_s, run.time_s, run.unsettled_s)),
    )
