"""Soft symbols: their amplitude and noise, and what is made of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .. import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

BURST_SYMBOLS = 150
LEVEL_SYMBOLS = 300
UNEVEN = 1.4
"""Medians of so many symbols in noise differ by a fifth."""
FADED = 0.3
"""Less of the usual amplitude is noise, which is not raised to it."""
LEAST_NOISE = 0.01
UNCERTAIN = 0.4
"""Symbols are weaker than others where less than this of their certainty is left; what is more is
not told from chance."""


@dataclass(frozen=True)
class Decoded:
    """Subframes, most likely bits: F subframes of W words (or blocks of a code)."""

    bits: NDArray[np.uint8]
    """(F, 300), in the ICD's order; source data and parity."""
    corrected: NDArray[np.intp]
    """(F, W): bits that differ from the hard decisions."""
    doubt: NDArray[np.float64]
    """(F, W): probability that the word is wrong."""


def doubt(
    costs: NDArray[np.float64], weight: NDArray[np.float32], more: int, noise: float
) -> NDArray[np.float64]:
    """Probability (N,) that the cheapest of several explanations (N, K) of a word is wrong.

    A cost is the sum of the magnitudes ``weight`` (N, symbols) of the symbols of amplitude 1 that
    would be wrong; those of ``more`` symbols or beyond are not among the explanations. The law is
    in the core (``fec/doubt.rs``).
    """
    magnitudes = np.ascontiguousarray(weight, np.float64)
    return _core.word_doubt(np.ascontiguousarray(costs), magnitudes, more, noise)


def amplitude_and_noise(values: NDArray[np.float32]) -> tuple[float, float]:
    """Amplitude, and standard deviation of the noise, of symbols +-A in Gaussian noise.

    Missing ones (0) are left out. Without any signal the amplitude is 0.
    """
    present = values[values != 0].astype(np.float64)
    if not present.size:
        return 0.0, 1.0
    power, noise = _moments(present[None])
    return float(np.sqrt(power[0])), float(np.sqrt(noise[0]))


def _moments(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A^2 and s^2 of rows by second and fourth moments: M2 = A^2 + s^2, 3 M2^2 - M4 = 2 A^4."""
    squares = values**2
    second, fourth = squares.mean(axis=1), (squares**2).mean(axis=1)
    power = np.minimum(np.sqrt(np.maximum(3 * second**2 - fourth, 0.0) / 2), second)
    return power, second - power


def levelled(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Symbols of about even amplitude, where a stronger signal has taken over, or one has faded.

    One amplitude and one noise would take the change for noise. Where the blocks' medians differ by
    less than :data:`UNEVEN`, which noise alone makes them do, the symbols are left as they are.
    """
    count = values.size // LEVEL_SYMBOLS
    if count < 2:
        return values
    rows = np.abs(values[: count * LEVEL_SYMBOLS].reshape(count, LEVEL_SYMBOLS))
    level = np.median(rows, axis=1)
    usual = float(np.median(level))
    level = np.maximum(level, FADED * usual)
    if usual == 0.0 or level.max() < UNEVEN * level.min():
        return values
    middles = LEVEL_SYMBOLS * (np.arange(count) + 0.5)
    around = np.interp(np.arange(values.size) + 0.5, middles, level)
    return np.asarray(values * (usual / around), dtype=np.float32)


def weighted(values: NDArray[np.float32], noise: float) -> NDArray[np.float32]:
    """Symbols of amplitude 1; those in bursts of noise and fades are made as uncertain as they are.

    The certainty of a symbol y is 2 A y / s^2; decoders take A = 1 and s = ``noise`` throughout.
    """
    count = values.size // BURST_SYMBOLS
    if count < 2:
        return values
    rows = values[: count * BURST_SYMBOLS].reshape(count, BURST_SYMBOLS).astype(np.float64)
    power, variance = _moments(rows)
    share = (noise**2 + LEAST_NOISE**2) * np.sqrt(power) / (variance + LEAST_NOISE**2)
    share[share > UNCERTAIN] = 1.0
    share = np.concatenate([share, share[-1:]])
    around = np.minimum(share, np.minimum(np.roll(share, 1), np.roll(share, -1)))
    around[0], around[-1] = min(share[:2]), min(share[-2:])
    weights = np.repeat(around, BURST_SYMBOLS)[: values.size]
    return np.asarray(values * weights, dtype=np.float32)
