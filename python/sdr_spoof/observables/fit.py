"""Values at an instant from the rows around it: a parabola fitted to those of a short window.

Rows are measured over integrations of 1 to 20 ms and have the times of their middles. A parabola
leaves any constant Doppler rate without bias; a jerk of 10 m/s^3 leaves 0.2 mm. At the middle of
n rows of white noise, a parabola's value has the variance (9 n^2 - 21) / (4 n (n^2 - 4)) of one
row: 0.21 with 11 rows (Savitzky, Golay, Anal. Chem. 36 (1964) 1627).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

TERMS = 3
MOST_AT_ONCE = 1 << 14
"""Instants worked on at a time, to bound the memory."""


@dataclass(frozen=True)
class Stencil:
    """How M instants are read from the rows around each of them."""

    rows: NDArray[np.intp]
    """(M, K) rows used."""
    value: NDArray[np.float64]
    """(M, K) weights for the value."""
    slope: NDArray[np.float64]
    """(M, K) weights for the rate, per second."""

    def values(self, column: NDArray[np.float64]) -> NDArray[np.float64]:
        """Value of a column at each instant, (M,)."""
        first = column[self.rows[:, 0]]
        steps = self.value * (column[self.rows] - first[:, None])
        return np.asarray(first + steps.sum(axis=1))

    def slopes(self, column: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rate of a column at each instant, per second, (M,)."""
        first = column[self.rows[:, 0]]
        return np.asarray((self.slope * (column[self.rows] - first[:, None])).sum(axis=1))

    def every(self, column: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a flag is set in all rows used, (M,)."""
        return np.asarray(column[self.rows].all(axis=1))

    def some(self, column: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a flag is set in any row used, (M,)."""
        return np.asarray(column[self.rows].any(axis=1))


def stencil(row_times_s: NDArray[np.float64], times_s: NDArray[np.float64], count: int) -> Stencil:
    """Weights of the ``count`` rows (three at least) nearest to each instant.

    ``row_times_s`` (N,) ascends, N >= 3; instants lie between the first and the last of them.
    """
    count = min(max(count, TERMS) | 1, row_times_s.size)
    middle = np.searchsorted(0.5 * (row_times_s[1:] + row_times_s[:-1]), times_s)
    first = np.clip(middle - count // 2, 0, row_times_s.size - count)
    rows = first[:, None] + np.arange(count)
    weights = [
        _weights(row_times_s[rows[i : i + MOST_AT_ONCE]] - times_s[i : i + MOST_AT_ONCE, None])
        for i in range(0, max(len(times_s), 1), MOST_AT_ONCE)
    ]
    value, slope = (np.concatenate([w[i] for w in weights]) for i in range(2))
    return Stencil(rows, value, slope)


def _weights(
    offsets_s: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weights for value and slope at zero of the least-squares parabola, each (M, K)."""
    scale = np.maximum(np.abs(offsets_s).max(axis=1, initial=0.0), 1e-9)[:, None]
    u = offsets_s / scale
    powers = [np.sum(u**n, axis=1) for n in range(2 * TERMS - 1)]
    normal = np.stack([np.stack(powers[i : i + TERMS], axis=1) for i in range(TERMS)], axis=1)
    inverse = np.linalg.inv(normal)
    design = np.stack([np.ones_like(u), u, u * u], axis=1)
    value = np.sum(inverse[:, 0, :, None] * design, axis=1)
    slope = np.sum(inverse[:, 1, :, None] * design, axis=1) / scale
    return value, slope
