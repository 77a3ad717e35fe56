"""Where values lie on an axis, and where its ticks are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
MOST_DIGITS = 6
"""Of a tick's number; larger or smaller ones are written with an exponent."""


@dataclass(frozen=True)
class Symlog:
    """Linear up to ``within`` on either side of zero, logarithmic beyond."""

    within: float
    room: float
    """What the linear part to one side takes, in decades."""

    def __call__(self, values: ArrayLike) -> NDArray[np.float64]:
        """Decades from zero."""
        size = np.abs(np.asarray(values, dtype=np.float64)) / self.within
        outer = self.room + np.log10(np.maximum(size, 1.0))
        return np.asarray(np.sign(values) * np.where(size <= 1.0, self.room * size, outer))


@dataclass(frozen=True)
class Scale:
    """A stretch of values."""

    low: float
    high: float
    symlog: Symlog | None = None

    def at(self, values: ArrayLike) -> NDArray[np.float64]:
        """Where values lie, 0 at the low end and 1 at the high one."""
        turn = self.symlog or (lambda v: np.asarray(v, dtype=np.float64))
        low, high = float(turn(self.low)), float(turn(self.high))
        return np.asarray((turn(values) - low) / (high - low))


def stretch(low: float, high: float, share: float) -> tuple[float, float]:
    """Limits with some room around them; a single value gets room too."""
    if not (np.isfinite(low) and np.isfinite(high)):
        return 0.0, 1.0
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        room = 0.05 * max(abs(low), 1e-12) if low else 1.0
        return low - room, high + room
    return low - share * (high - low), high + share * (high - low)


def ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers within limits, no more than about ``most``."""
    rough = (high - low) / max(most, 1)
    decade = 10.0 ** np.floor(np.log10(rough))
    step = decade * next(s for s in STEPS if s * decade >= rough * (1.0 - 1e-9))
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [float(n * step) for n in np.arange(first, last + 1)]


def names(values: Sequence[float]) -> list[str]:
    """Numbers of ticks with as many decimals as they need."""
    largest = max((abs(v) for v in values), default=0.0)
    finest = min(np.diff(sorted(values)), default=largest)
    if largest >= 10.0**MOST_DIGITS or 0.0 < largest < 1e-4:
        return [_signed(f"{v:.3g}") for v in values]

    def enough(decimals: int) -> bool:
        return all(abs(round(v, decimals) - v) <= 1e-6 * finest for v in values)

    decimals = next(filter(enough, range(MOST_DIGITS)), MOST_DIGITS)
    return [_signed(f"{v:.{decimals}f}") for v in values]


def _signed(number: str) -> str:
    """With a minus of its own; no zero has one."""
    return number.lstrip("-") if not number.strip("-0.") else number.replace("-", "−")
