"""Fewer points whose line looks the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_POINTS = 4000
"""Points of a line that is kept; a picture is 1000 units wide."""


def thinned(
    time_s: NDArray[np.float64], values: NDArray[np.float64], most: int = MOST_POINTS
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Fewer points whose line looks the same: the lowest and highest of equal runs of rows.

    A run in which a value is NaN keeps one, so that the line breaks there. Lines of no more than
    ``most`` points stay as they are.
    """
    if time_s.size <= most:
        return time_s, values
    run = -(-2 * time_s.size // most)
    starts = np.arange(0, time_s.size, run)
    runs = np.pad(values, (0, starts.size * run - time_s.size), "edge").reshape(-1, run)
    gaps = np.isnan(runs)
    lowest = np.where(gaps, np.inf, runs).argmin(axis=1)
    highest = np.where(gaps, -np.inf, runs).argmax(axis=1)
    gap = np.where(gaps.any(axis=1), gaps.argmax(axis=1), lowest)
    rows = np.unique(np.minimum(starts + np.array([lowest, highest, gap]), time_s.size - 1))
    return time_s[rows], values[rows]
