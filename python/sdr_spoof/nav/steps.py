"""How far the words of a run go on in step with a subframe.

Samples missing by whole symbols move all symbols that follow, which neither code nor secondary code
shows. The parity of words does: in step it holds (at 26 dB-Hz one word of 50 000 fails), out of
step it holds by chance: in one word of 256 (D1, D2) or 32 (LNAV, either sign), but in half of them
where D1 or D2 is one symbol off, since their interleaved code is cyclic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .bits import PAGE_BITS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray

WORD = 30
FAILURES = 2
"""So many words that fail are out of step, not unlucky."""
LOSING_S = 0.75
"""A signal that has vanished, or a pilot out of step, is called lost within this."""
BACK_OFF = 5
"""So many words before the first that fails may be out of step too."""


@dataclass(frozen=True)
class Reach:
    """What is in step with a frame, receiver time."""

    held_from_s: float = math.inf
    """Start of the first word from which on none fails up to the frame."""
    held_until_s: float = -math.inf
    failed_before_s: float | None = None
    """Start of the last word before the frame that fails."""
    failed_after_s: float | None = None
    """End of the first word after the frame's start that fails."""
    from_s: float = -math.inf
    """Before this, several words fail; infinite where they do not."""
    until_s: float = math.inf
    before_s: tuple[float, ...] = ()
    """Start of each word before the frame that holds, up to one that fails."""
    after_s: tuple[float, ...] = ()
    """End of each word after the frame's start that holds, up to one that fails."""
    run_from_s: float = -math.inf
    """First and last instant of the run that is trusted; a frame may reach beyond."""
    run_until_s: float = math.inf


@dataclass(frozen=True)
class Steps:
    """Words on one side of a subframe's start, counted from there."""

    holding: tuple[int, ...]
    """Those that hold before one fails."""
    failed: int | None
    """The first that fails."""
    out: bool
    """Whether several do."""

    @property
    def held(self) -> int:
        """Up to the last one that holds before one fails."""
        return self.holding[-1] + 1 if self.holding else 0


def steps(
    values: NDArray[np.float32],
    start: int,
    failing: Callable[[NDArray[np.uint8]], NDArray[np.bool_]],
) -> tuple[Steps, Steps]:
    """Words before and after the first symbol of a subframe.

    Words that are incomplete, or whose bits are all the same, say nothing. ``failing`` says which
    words (F, 10) of subframes (F, 300) of bits, of either sign, fail.
    """
    ahead = -start % PAGE_BITS
    behind = -(values.size + ahead) % PAGE_BITS
    padded = np.concatenate([np.zeros(ahead), values, np.zeros(behind)])
    votes = _votes(padded, failing)
    word = (start + ahead) // WORD
    return _steps(votes[:word][::-1]), _steps(votes[word:])


def _votes(
    padded: NDArray[np.float64], failing: Callable[[NDArray[np.uint8]], NDArray[np.bool_]]
) -> NDArray[np.intp]:
    """Of each word: 1 its parity holds, -1 it fails, 0 it says nothing."""
    hard = (padded < 0).astype(np.uint8)
    wrong = failing(hard.reshape(-1, PAGE_BITS)).reshape(-1)
    words = hard.reshape(-1, WORD)
    ones = words.sum(axis=1)
    whole = (padded.reshape(-1, WORD) != 0).all(axis=1)
    telling = whole & (ones > 0) & (ones < WORD)
    return np.asarray(np.where(telling, np.where(wrong, -1, 1), 0))


def _steps(votes: Iterable[int]) -> Steps:
    holding: list[int] = []
    failures: list[int] = []
    for n, vote in enumerate(votes):
        if vote > 0 and not failures:
            holding.append(n)
        elif vote < 0:
            failures.append(n)
            if len(failures) == FAILURES:
                break
    return Steps(tuple(holding), failures[0] if failures else None, len(failures) == FAILURES)


def reach(times_s: NDArray[np.float64], start: int, before: Steps, after: Steps) -> Reach:
    """The same in receiver time; ``times_s`` is that of each symbol's start, and of the end."""

    def at(words: int) -> float:
        return float(times_s[min(max(start + WORD * words, 0), times_s.size - 1)])

    return Reach(
        held_from_s=at(-before.held),
        held_until_s=at(after.held),
        failed_before_s=None if before.failed is None else at(-before.failed - 1),
        failed_after_s=None if after.failed is None else at(after.failed + 1),
        from_s=at(BACK_OFF - (before.failed or 0)) if before.out else -math.inf,
        until_s=at((after.failed or 0) - BACK_OFF) if after.out else math.inf,
        before_s=tuple(at(-n - 1) for n in before.holding),
        after_s=tuple(at(n + 1) for n in after.holding),
    )
