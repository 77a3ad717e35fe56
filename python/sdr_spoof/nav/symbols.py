"""Soft symbols from tracks.

A row of a synchronised track is a whole number of code periods within one symbol, secondary code
wiped; rows of 10 ms are halves of a 20 ms symbol. Which rows belong together is not recorded: of
all ways to group them, the one that keeps most power is right, since rows of one symbol have one
sign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from ..gaps import counted
from ..records import PART_EPOCHS, SignalTrack, State
from ..signals import signal_spec
from .records import SymbolRun
from .soft import amplitude_and_noise

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from ..gaps import Span
    from ..signals import SignalSpec

__all__ = ["Stretch", "SymbolRun", "stretches_of", "symbols_of"]

COMPANION = {"B1CP": "B1CD"}
"""Pilots whose rows hold the data component's prompt, and which signal that is."""
LONGEST_GAP_S = 0.5
"""Rows may be missing for so long within a run; the symbols there are 0."""
FEWEST_SYMBOLS = 8
"""A shorter run is of no use."""
SURE = math.log(1e6)
"""Logarithm of how much likelier a grouping of rows must be than any other."""
LEAST_NOISE = 0.05
"""Noise over amplitude is taken for no less."""


@dataclass(frozen=True)
class Stretch:
    """An unbroken part of a track, in which the code phase counts on."""

    signal: str
    prn: int
    from_s: float
    until_s: float


def stretches_of(track: SignalTrack, uncounted: Sequence[Span] = ()) -> list[Stretch]:
    """Unbroken parts of the synchronised rows of a track, without spans where the count ended."""
    spec = signal_spec(track.signal)
    rows = _Rows(track, spec, uncounted)
    parts = []
    for part in rows.stretches(spec):
        begin, end = rows.time_s[part.start], rows.time_s[part.stop - 1]
        half = 0.5 * rows.integration_s[part.start]
        parts.append(Stretch(track.signal, track.prn, float(begin - half), float(end + half)))
    return parts


def code_phase_at(track: SignalTrack, time_s: float) -> float:
    """Received code phase at a receiver time, from the synchronised row nearest to it."""
    spec = signal_spec(track.signal)
    usable = np.flatnonzero(track.state >= State.SYNCED)
    times = track.time_s[usable]
    row = int(usable[np.abs(times - time_s).argmin()])
    rate = spec.chip_rate_hz * (1.0 + float(track.doppler_hz[row]) / spec.carrier_hz)
    return float(track.code_phase_chips[row] + rate * (time_s - track.time_s[row]))


def symbols_of(track: SignalTrack, uncounted: Sequence[Span] = ()) -> list[SymbolRun]:
    """Symbols of a track, one run for each unbroken stretch of it; none of a pilot alone."""
    signal = COMPANION.get(track.signal, track.signal)
    spec = signal_spec(signal)
    periods = _core.periods_per_symbol(signal, track.prn)
    if periods is None or not track.epochs:
        return []
    rows = _Rows(track, spec, uncounted)
    value = np.concatenate([np.zeros(0), *_prompts(track, signal != track.signal)])[rows.usable]
    if not value.any():
        return []
    runs = (
        _run(rows, value[part], part, signal, track.prn, periods, spec)
        for part in rows.stretches(spec)
    )
    return [run for run in runs if run is not None]


class _Rows:
    """Columns of the synchronised rows of a track."""

    def __init__(self, track: SignalTrack, spec: SignalSpec, uncounted: Sequence[Span]) -> None:
        state = track.state
        outside, spans = counted(track.time_s, 0.5 * track.integration_s, uncounted)
        self.usable = usable = (state >= State.SYNCED) & outside
        self.lost = (np.cumsum(state <= State.PULL_IN) + spans)[usable]
        """Losses before each row: a new one begins a new count of code phase."""
        self.time_s = track.time_s[usable]
        self.integration_s = track.integration_s[usable]
        nominal = self.integration_s * spec.chip_rate_hz
        begin = track.code_phase_chips[usable] - 0.5 * nominal
        self.code_phase = track.code_phase_chips[usable]
        self.rate = spec.chip_rate_hz * (1.0 + track.doppler_hz[usable] / spec.carrier_hz)
        self.first = np.round(begin / spec.code_length).astype(np.int64)
        """Code period with which each row begins."""
        self.periods = np.round(nominal / spec.code_length).astype(np.int64)

    def time_of(self, chips: NDArray[np.float64], part: slice) -> NDArray[np.float64]:
        """Receiver time of code phases, from the nearest row."""
        phase = self.code_phase[part]
        after = np.clip(np.searchsorted(phase, chips), 0, phase.size - 1)
        before = np.maximum(after - 1, 0)
        near = np.where(chips - phase[before] < phase[after] - chips, before, after)
        late = (chips - phase[near]) / self.rate[part][near]
        return np.asarray(self.time_s[part][near] + late)

    def stretches(self, spec: SignalSpec) -> Iterator[slice]:
        """Rows between which the code phase runs on."""
        if not self.first.size:
            return
        step = self.first[1:] - self.first[:-1] - self.periods[:-1]
        longest = round(LONGEST_GAP_S / spec.period_s)
        elapsed = np.round(np.diff(self.time_s - 0.5 * self.integration_s) / spec.period_s)
        jumps = np.abs(elapsed - np.diff(self.first)) > 1
        breaks = (step < 0) | (step > longest) | (np.diff(self.lost) > 0) | jumps
        breaks |= self.periods[1:] != self.periods[:-1]
        edges = [0, *(np.flatnonzero(breaks) + 1).tolist(), self.first.size]
        for start, stop in pairwise(edges):
            yield slice(start, stop)


def _prompts(track: SignalTrack, data: bool) -> Iterator[NDArray[np.float64]]:
    """Real prompts, a part of the track at a time: taps are its largest column."""
    if data:
        yield track.data_prompt.real.astype(np.float64)
        return
    for at in range(0, track.epochs, PART_EPOCHS):
        taps = track.part(at, at + PART_EPOCHS).taps
        yield taps[:, track.prompt_tap].real.astype(np.float64)


def _run(
    rows: _Rows,
    row_values: NDArray[np.float64],
    part: slice,
    signal: str,
    prn: int,
    periods: int,
    spec: SignalSpec,
) -> SymbolRun | None:
    per_row = int(rows.periods[part.start])
    if per_row == 0 or periods % per_row:
        return None
    per_symbol = periods // per_row
    places = (rows.first[part] - rows.first[part.start]) // per_row
    values = np.zeros(int(places[-1]) + 1)
    values[places] = row_values
    offset, grouped = _grouping(values, per_symbol)
    count = (values.size - offset) // per_symbol
    if count < FEWEST_SYMBOLS:
        return None
    symbols = values[offset : offset + count * per_symbol].reshape(count, per_symbol)
    present = np.zeros(values.size, dtype=bool)
    present[places] = True
    whole = present[offset : offset + count * per_symbol].reshape(count, per_symbol).all(axis=1)
    soft = np.where(whole, symbols.sum(axis=1), 0.0)
    mean = np.abs(soft[whole]).mean() if whole.any() else 0.0
    if mean == 0.0:
        return None
    first = rows.first[part.start] + offset * per_row
    chips = (first + np.arange(count) * periods) * float(spec.code_length)
    return SymbolRun(
        signal=signal,
        prn=prn,
        code_phase_chips=chips,
        time_s=rows.time_of(chips, part),
        values=(soft / mean).astype(np.float32),
        symbol_s=periods * spec.period_s,
        grouped=grouped,
    )


def _grouping(values: NDArray[np.float64], per_symbol: int) -> tuple[int, bool]:
    """Row with which the first whole symbol begins, and whether that is beyond doubt: symbols that
    are all the same leave it open."""
    if per_symbol == 1:
        return 0, True
    powers = []
    for offset in range(per_symbol):
        count = (values.size - offset) // per_symbol
        groups = values[offset : offset + count * per_symbol].reshape(count, per_symbol)
        powers.append(np.mean(groups.sum(axis=1) ** 2) if count else 0.0)
    best = int(np.argmax(powers))
    amplitude, noise = amplitude_and_noise(values.astype(np.float32))
    if amplitude == 0.0:
        return best, False
    scaled = values * (amplitude / max(noise, LEAST_NOISE * amplitude) ** 2)
    likely = [_likelihood(scaled, offset, per_symbol) for offset in range(per_symbol)]
    return best, all(likely[best] - one > SURE for i, one in enumerate(likely) if i != best)


def _likelihood(scaled: NDArray[np.float64], offset: int, per_symbol: int) -> float:
    """Logarithm of how likely rows are, in units of noise^2 over amplitude, grouped from a row on;
    the rows of a symbol, also of those cut off at the ends, have one sign."""
    ahead = -offset % per_symbol
    padded = np.pad(scaled, (ahead, -(ahead + scaled.size) % per_symbol))
    sums = np.abs(padded.reshape(-1, per_symbol).sum(axis=1))
    return float(np.sum(np.logaddexp(sums, -sums)))
