"""Finds the subframes of LNAV, D1 and D2 among symbols, with bit errors, of either sign.

A place is believed where the chance that random symbols look so is below 10^-8: a preamble
with few errors, words whose parity holds, and a time of week and a subframe number that belong
together. Once one is found, others are looked for where they must be, and believed if they tell the
time that is expected there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Protocol

import numpy as np
from scipy.stats import binom

from .bits import PAGE_BITS

if TYPE_CHECKING:
    from numpy.typing import NDArray

SURE = -8.0
"""log10 of the chance below which a place is believed."""
MOST_ERRORS, EXPECTED_ERRORS = 2, 4
"""Wrong bits of a preamble that are borne; and where one is expected."""
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

    def indices(self, soft: NDArray[np.float32]) -> list[int | None]:
        """Of each subframe (F, 300), which it is since the start of the week; None where its time
        and its number do not go together.
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
    """Subframes in symbols (N,), in order; the last may be cut off by the end."""
    chosen: list[Found] = []
    for found in sorted(_sure(values, framing), key=lambda f: f.log10_chance):
        if all(abs(found.start - other.start) >= PAGE_BITS for other in chosen):
            chosen.append(found)
    chosen += _expected(values, framing, sorted(chosen, key=lambda f: f.start))
    return sorted(chosen, key=lambda f: f.start)


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
        chance += np.log10(2 * binom.cdf(fewest[part], size, 0.5))
        likely = chance < SURE
        found += _timed(framing, soft[likely], part[likely], signs[likely], chance[likely])
    return found


def _timed(
    framing: Framing,
    soft: NDArray[np.float32],
    starts: NDArray[np.intp],
    signs: NDArray[np.intp],
    chances: NDArray[np.float64],
) -> list[Found]:
    """Those whose time and number go together."""
    return [
        Found(int(start), int(sign), index, float(chance))
        for start, sign, chance, index in zip(
            starts, signs, chances, framing.indices(soft), strict=True
        )
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
    found = _timed(framing, soft, places, signs, np.full(places.size, SURE))
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
    n = np.arange(words + 1)
    chances = binom.cdf(n[None, :], n[:, None], share)
    return np.asarray(np.log10(np.maximum(chances, 1e-300)))
