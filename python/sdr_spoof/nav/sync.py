"""Finds the subframes of LNAV, D1 and D2 among symbols, with bit errors, of either sign.

A place is believed where the chance that random symbols look so is below 10^-8: a preamble
with few errors, words whose parity holds, and a time of week and a subframe number that belong
together. Once one is found, others are looked for where they must be, and believed if they tell the
time that is expected there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import comb
from typing import TYPE_CHECKING, Protocol

import numpy as np

from .bits import PAGE_BITS

if TYPE_CHECKING:
    from numpy.typing import NDArray

SURE = -8.0
"""log10 of the chance below which a place is believed."""
MOST_ERRORS, EXPECTED_ERRORS = 2, 4
"""Wrong bits of a preamble that are borne; and where one is expected."""
MOST_DOUBT = 1e-5
"""A time that is wrong with more than this probability is not believed; where it is expected it is.
"""
BATCH = 4096


class Framing(Protocol):
    """What distinguishes the subframes of one message from those of another."""

    preamble: NDArray[np.uint8]
    head: int
    """Symbols that tell the time."""
    log10_chance: float
    """Of a random time and number to go together."""

    def chances(self, soft: NDArray[np.float32], length: NDArray[np.intp]) -> NDArray[np.float64]:
        """log10 of the chance that as few words of random subframes (F, 300) fail, of which the
        first ``length`` symbols are there.
        """

    def indices(self, soft: NDArray[np.float32], most_doubt: float) -> list[int | None]:
        """Of each subframe (F, 300), which it is since the start of the week; None where its time
        and its number do not go together, or are wrong with more than that probability.
        """


@dataclass(frozen=True)
class Found:
    """A subframe."""

    start: int
    """Its first symbol."""
    sign: int
    """-1: inverted, by its preamble."""
    index: int
    """Subframes since the start of the week."""
    log10_chance: float


def windows(values: NDArray[np.float32], starts: NDArray[np.intp]) -> NDArray[np.float32]:
    """300 symbols from each start on, zeros beyond the end: (S, 300)."""
    padded = np.concatenate([values, np.zeros(PAGE_BITS, np.float32)])
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, PAGE_BITS)[starts])


def preamble_errors(values: NDArray[np.float32], preamble: NDArray[np.uint8]) -> NDArray[np.intp]:
    """Errors of a preamble of right sign at each symbol; an inverted one has all bits wrong."""
    if values.size < preamble.size:
        return np.zeros(0, np.intp)
    hard = np.where(values < 0, 1, -1)
    agreement = np.correlate(hard, 2 * preamble.astype(np.intp) - 1, "valid")
    return np.asarray((preamble.size - agreement) // 2)


def find(values: NDArray[np.float32], framing: Framing) -> list[Found]:
    """Subframes in symbols (N,), in order; the last may be cut off by the end.

    Those that agree on the time support each other: of two that overlap, the one with more support
    is taken. (After a gap in the recording the time may be another.)
    """
    taken = np.zeros(values.size + PAGE_BITS, dtype=bool)
    chosen: list[Found] = []
    for agreeing in _by_time(_sure(values, framing)):
        known = _free(agreeing, taken)
        if known:
            chosen += known
            chosen += _free(_expected(values, framing, known), taken)
    return sorted(chosen, key=lambda f: f.start)


def _by_time(found: list[Found]) -> list[list[Found]]:
    """Groups that agree on the time, in the order of symbols, the least likely by chance first."""
    groups: dict[int, list[Found]] = {}
    for f in found:
        groups.setdefault(f.start - PAGE_BITS * f.index, []).append(f)
    return sorted(groups.values(), key=lambda g: sum(f.log10_chance for f in g))


def _free(found: list[Found], taken: NDArray[np.bool_]) -> list[Found]:
    """Those whose symbols are not taken by others; they take them."""
    free = []
    for f in found:
        symbols = taken[f.start : f.start + PAGE_BITS]
        if not symbols.any():
            symbols[:] = True
            free.append(f)
    return free


def _sure(values: NDArray[np.float32], framing: Framing) -> list[Found]:
    size = framing.preamble.size
    errors = preamble_errors(values, framing.preamble)[: max(0, values.size - framing.head + 1)]
    fewest = np.minimum(errors, size - errors)
    starts = np.flatnonzero(fewest <= MOST_ERRORS)
    found: list[Found] = []
    for at in range(0, starts.size, BATCH):
        part = starts[at : at + BATCH]
        signs = np.where(errors[part] <= MOST_ERRORS, 1, -1)
        soft = windows(values, part) * signs[:, None].astype(np.float32)
        chance = framing.chances(soft, values.size - part) + framing.log10_chance
        chance += np.log10(2.0) + word_chances(size, 0.5)[size, fewest[part]]
        likely = chance < SURE
        indices = framing.indices(soft[likely], MOST_DOUBT)
        found += _timed(indices, part[likely], signs[likely], chance[likely])
    return found


def _timed(
    indices: list[int | None],
    starts: NDArray[np.intp],
    signs: NDArray[np.intp],
    chances: NDArray[np.float64],
) -> list[Found]:
    """Those whose time and number go together."""
    return [
        Found(int(start), int(sign), index, float(chance))
        for start, sign, chance, index in zip(starts, signs, chances, indices, strict=True)
        if index is not None
    ]


def _expected(values: NDArray[np.float32], framing: Framing, known: list[Found]) -> list[Found]:
    """Subframes whole multiples from a known one, which tell the time that they must."""
    wanted = _wanted(values.size - framing.head, known)
    if not wanted:
        return []
    places = np.array(list(wanted), dtype=np.intp)
    size = framing.preamble.size
    errors = preamble_errors(values, framing.preamble)[places]
    signs = np.where(errors <= size // 2, 1, -1)
    near = np.minimum(errors, size - errors) <= min(EXPECTED_ERRORS, size // 2 - 1)
    places, signs = places[near], signs[near]
    soft = windows(values, places) * signs[:, None].astype(np.float32)
    found = _timed(framing.indices(soft, 1.0), places, signs, np.full(places.size, SURE))
    return [f for f in found if wanted[f.start] == f.index]


def _wanted(last: int, known: list[Found]) -> dict[int, int]:
    """Starts of subframes that lie between known ones, before and after, and their indices."""
    wanted: dict[int, int] = {}
    for n, found in enumerate(known):
        until = known[n + 1].start - PAGE_BITS if n + 1 < len(known) else last
        steps = list(range(1, (until - found.start) // PAGE_BITS + 1))
        if n == 0:
            steps += list(range(-(found.start // PAGE_BITS), 0))
        wanted.update({found.start + PAGE_BITS * k: found.index + k for k in steps})
    return wanted


@cache
def word_chances(words: int, share: float) -> NDArray[np.float64]:
    """log10 of the chance that at most k of n words fail, a random one with this share: [n, k]."""
    table = np.zeros((words + 1, words + 1))
    for n in range(words + 1):
        chances = [comb(n, k) * share**k * (1 - share) ** (n - k) for k in range(n + 1)]
        table[n, : n + 1] = np.log10(np.cumsum(chances))
    return table
