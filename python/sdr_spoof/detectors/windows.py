"""Sections of a long track, unbroken pieces of tracking, least-squares slopes over windows."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.records import Track

SECTION_EPOCHS = 1 << 18
"""Epochs of a track that are tested at a time: 44 minutes of 10 ms, about 55 MB with all that is
computed from them."""
GAP_EPOCHS = 1.5
"""A step in time longer than this many epochs is a gap."""


def sections(track: Track, lead_s: float) -> Iterator[tuple[int, int, int]]:
    """Split a track: first row, row behind the last, and how many are those of the part before.

    The latter, ``lead_s`` long, are there so that windows reach back over the seam. A track of no
    more than ``SECTION_EPOCHS`` is one section.
    """
    for first in range(0, max(track.epochs, 1), SECTION_EPOCHS):
        lead = 0
        if first > 0:
            epoch_s = float(track.part(first, first + 1).integration_s[0])
            lead = min(first, round(lead_s / epoch_s))
        yield first - lead, first + SECTION_EPOCHS, lead


def segments(time_s: NDArray[np.float64], usable: NDArray[np.bool_]) -> list[slice]:
    """Maximal runs of usable rows without a gap in time, as slices of at least two rows."""
    rows = np.flatnonzero(usable)
    if rows.size < 2:
        return []
    epoch_s = float(np.median(np.diff(time_s)))
    steps = np.diff(time_s[rows])
    breaks = np.flatnonzero((np.diff(rows) > 1) | (steps > GAP_EPOCHS * epoch_s) | (steps <= 0.0))
    starts = np.concatenate(([0], breaks + 1))
    ends = np.concatenate((breaks, [rows.size - 1]))
    return [
        slice(int(rows[a]), int(rows[b]) + 1) for a, b in zip(starts, ends, strict=True) if b > a
    ]


def sliding_slope(values: NDArray[np.float64], rows: int, epoch_s: float) -> NDArray[np.float64]:
    """Least-squares slope per second over every window of ``rows`` equally spaced values.

    Returns one slope per window, shape (len(values) - rows + 1,); row k covers values
    [k, k + rows).
    """
    lever = np.arange(rows) - (rows - 1) / 2.0
    centred = values - values[0]
    return np.correlate(centred, lever, mode="valid") / (float(lever @ lever) * epoch_s)


def sliding_mean(values: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """Mean over every window of ``rows`` values, shape (len(values) - rows + 1,)."""
    return np.correlate(values, np.full(rows, 1.0 / rows), mode="valid")


def slope_sigma(value_sigma: NDArray[np.float64], rows: int, epoch_s: float) -> NDArray[np.float64]:
    """Standard deviation of the slope where each value has white noise ``value_sigma``.

    The textbook law sigma^2 / sum (t - mean t)^2 = 12 sigma^2 / (T^2 N (N^2 - 1)).
    """
    return np.asarray(value_sigma * np.sqrt(12.0 / (rows * (rows**2 - 1.0))) / epoch_s)


def moving_sum(
    values: NDArray[np.float64], start: NDArray[np.int64], stop: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Sum over rows [start, stop) of each window, which may differ in length; O(N)."""
    total = np.concatenate(([0.0], np.cumsum(values)))
    return np.asarray(total[stop] - total[start])
