"""Instants at which the carrier phases of all signals step: samples may be missing there.

Samples missing by whole symbols leave locks, codes and symbols as they were, but not the phases:
each satellite's has gone on by its Doppler times what is missing, a step that has nothing to do
with the others'. Where no satellite moves enough for that, none has moved enough to spoil a fix.

The step is that between two straight lines, through 60 ms of phases on either side, up to 15 ms
from the instant. A motion bends both lines alike. What it comes to, in its own variances and
bounded so that no single signal decides, is summed over all signals: chi-square where nothing
happens.

This alone proves nothing, the receiver's oscillator may have been knocked: words and frames either
side say whether samples are missing (:mod:`sdr_spoof.nav.possible_gaps`).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtri

from .gaps import FEWEST
from .records import State
from .signals import signal_spec

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from .gaps import Span
    from .records import SignalTrack, TrackLog

GRID_S = 0.01
REACH_S, SKIP_S = 0.075, 0.015
"""How far a line reaches from the instant, and what is left out beside that."""
LEAST_ROWS = 3
CLEAR_CYCLES = 0.04
"""Rows with more noise are left out: it would make whole quanta now and then."""
QUANTUM_CYCLES = 0.5
"""Steps by less than a half of this are seen as they are, signs of data being unknown."""
AT_ONCE = 1000
"""Instants worked on at a time: running sums of long phases lose their digits."""
KNOCK_CYCLES = 0.02
"""Steps that a motion may make, one sigma: one by 1 g that sets in at once makes 0.04 cycles."""
MOST = 30.0
"""No signal counts for more than this, in variances."""
STANDS_OUT = 9.0
"""Signals with more than this are named, in variances."""
FOLLOWING_S = 0.75
"""Three time constants of a code loop of 1 Hz: what is left of 200 m shows in its discriminator."""
FALSE_ALARM = 1e-12
"""Of one instant; there are 360 000 in an hour."""


@dataclass(frozen=True)
class PhaseJump:
    """The phases of several satellites stepped at one instant, somewhere between two."""

    from_s: float
    until_s: float
    satellites: int
    """So many stand out."""

    @property
    def span(self) -> Span:
        """From the one until the code loops have followed: codes jump too, by up to 1 m in 1 ms."""
        return self.from_s, self.until_s + FOLLOWING_S


def phase_jumps_of(log: TrackLog) -> list[PhaseJump]:
    """Phase jumps of a recording, in order; those nearer than their own length are one."""
    count = int(log.duration_s / GRID_S) + 2
    total, signals = np.zeros(count, np.float32), np.zeros(count, np.intp)
    told = np.zeros(count, np.intp)
    for _, tracks in groupby(sorted(log.signals, key=_satellite), _satellite):
        stands_out = np.zeros(count, np.bool_)
        for first, variances in (s for t in tracks for s in _steps(t, count)):
            part = slice(first, first + variances.size)
            total[part] += variances
            signals[part] += 1
            stands_out[part] |= variances > STANDS_OUT
        told += stands_out
    most = np.append(np.inf, chdtri(np.arange(1.0, len(log.signals) + 1.0), FALSE_ALARM))
    rows = np.flatnonzero((total > most[signals]) & (told >= FEWEST + 1))
    groups = np.split(rows, np.flatnonzero(np.diff(rows) * GRID_S > REACH_S) + 1)
    return [
        PhaseJump(
            max(float(g[0]) * GRID_S - REACH_S, 0.0),
            float(g[-1]) * GRID_S + REACH_S,
            int(told[g].max()),
        )
        for g in groups
        if g.size
    ]


def _satellite(track: SignalTrack) -> tuple[str, int]:
    return signal_spec(track.signal).system, track.prn


def _steps(track: SignalTrack, count: int) -> Iterator[tuple[int, NDArray[np.float32]]]:
    """By unbroken piece: first place on the grid, and the step there in variances, bounded."""
    clear = _variance(track.cn0_dbhz, track.integration_s) < CLEAR_CYCLES**2
    kept = np.flatnonzero((track.state >= State.TRACKING) & clear)
    time_s, interval_s = track.time_s[kept], track.integration_s[kept]
    phase_cycles = _without_slips(time_s, track.carrier_phase_cycles[kept], track.doppler_hz[kept])
    cn0_dbhz = track.cn0_dbhz[kept]
    apart_s = 0.75 * (interval_s[1:] + interval_s[:-1])
    for run in np.split(np.arange(kept.size), np.flatnonzero(np.diff(time_s) > apart_s) + 1):
        if run.size < 2 * LEAST_ROWS:
            continue
        first = int((time_s[run[0]] + REACH_S) / GRID_S) + 1
        stop = min(int((time_s[run[-1]] - REACH_S) / GRID_S) + 1, count)
        for at in range(first, stop, AT_ONCE):
            grid_s = np.arange(at, min(at + AT_ONCE, stop), dtype=np.float64) * GRID_S
            ends_s = grid_s[0] - 2 * REACH_S, grid_s[-1] + 2 * REACH_S
            rows = run[slice(*np.searchsorted(time_s[run], ends_s))]
            lines = _Lines(time_s[rows], interval_s[rows], phase_cycles[rows], cn0_dbhz[rows])
            yield at, lines.steps(grid_s)


def _without_slips(
    time_s: NDArray[np.float64], phase_cycles: NDArray[np.float64], doppler_hz: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Phases without jumps by whole quanta from row to row, which would tilt lines."""
    expected = -0.5 * (doppler_hz[1:] + doppler_hz[:-1]) * np.diff(time_s)
    quanta = np.round((np.diff(phase_cycles) - expected) / QUANTUM_CYCLES)
    return np.asarray(phase_cycles - QUANTUM_CYCLES * np.cumsum(np.insert(quanta, 0, 0.0)))


class _Lines:
    """Straight lines through the phases of some rows, by running sums."""

    def __init__(
        self,
        time_s: NDArray[np.float64],
        interval_s: NDArray[np.float64],
        phase_cycles: NDArray[np.float64],
        cn0_dbhz: NDArray[np.float64],
    ) -> None:
        self.time_s, self.origin_s = time_s, time_s[0]
        late, phase = time_s - self.origin_s, phase_cycles - phase_cycles[0]
        weight = 1.0 / _variance(cn0_dbhz, interval_s)
        terms = np.stack([np.ones_like(late), late, late**2, phase, late * phase])
        self.sums = np.cumsum(np.insert(weight * terms, 0, 0.0, axis=1), axis=1)

    def steps(self, at_s: NDArray[np.float64]) -> NDArray[np.float32]:
        """At instants (M,): line after less line before, squared, in variances, bounded."""
        after, late = self._line(at_s, at_s + SKIP_S, at_s + REACH_S)
        before, early = self._line(at_s, at_s - REACH_S, at_s - SKIP_S)
        step = after - before
        step -= QUANTUM_CYCLES * np.round(step / QUANTUM_CYCLES)
        variances = step**2 / (late + early + KNOCK_CYCLES**2)
        return np.minimum(variances, MOST).astype(np.float32)

    def _line(
        self, at_s: NDArray[np.float64], from_s: NDArray[np.float64], until_s: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Value at instants of the lines through the rows between others, and its variance."""
        first, stop = (np.searchsorted(self.time_s, t) for t in (from_s, until_s))
        n, t, tt, p, tp = self.sums[:, stop] - self.sums[:, first]
        determinant = n * tt - t * t
        few = (stop - first < LEAST_ROWS) | (determinant <= 0.0)
        determinant = np.where(few, np.inf, determinant)
        x = at_s - self.origin_s
        value = ((tt * p - t * tp) + x * (n * tp - t * p)) / determinant
        variance = (tt - 2.0 * x * t + x * x * n) / determinant
        return value, np.where(few, np.inf, variance)


def _variance(
    cn0_dbhz: NDArray[np.float64], interval_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Thermal noise of the phase of a row, by a Costas discriminator, in cycles^2."""
    snr = np.maximum(10.0 ** (0.1 * cn0_dbhz) * interval_s, 1e-3)
    return np.asarray((1.0 + 0.5 / snr) / (8.0 * np.pi**2 * snr))


def sentences(jumps: Iterable[PhaseJump]) -> list[str]:
    """What is to be said of them."""
    return [
        f"the carriers of {j.satellites} satellites jumped at once between {j.from_s:.2f} and "
        f"{j.until_s:.2f} s: samples may be missing there; no time holds across"
        for j in jumps
    ]
