"""Mean of the last epochs minus what a line through the epochs before leads to expect.

A free INS drifts slowly: over a minute its velocity error is a line. The test sees the beginning
and the end of a drag, not a steady one, so that its alarm must latch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .power import Law

    Floats = NDArray[np.float64]


def weights(mean: int, baseline: int) -> Floats:
    """Of the last ``baseline + mean`` samples, oldest first; they sum up to 0, as does a line."""
    ahead = (baseline + mean) / 2
    centred = np.arange(baseline) - (baseline - 1) / 2
    line = 1 / baseline + ahead * centred / (centred @ centred)
    return np.concatenate([-line, np.full(mean, 1 / mean)])


def statistic(values: Floats, mean: int, baseline: int) -> Floats:
    """Of every epoch along the last axis; NaN where there are too few before it."""
    parts = weights(mean, baseline)
    found = np.full(values.shape, np.nan)
    if values.shape[-1] >= parts.size:
        windows = np.lib.stride_tricks.sliding_window_view(values, parts.size, axis=-1)
        found[..., parts.size - 1 :] = windows @ parts
    return found


def variance_factor(mean: int, baseline: int, law: Law = "differenced") -> float:
    """Variance of the statistic over that of one sample."""
    parts = weights(mean, baseline)
    neighbours = -0.5 if law == "differenced" else 0.0
    return float(parts @ parts + 2 * neighbours * (parts[1:] @ parts[:-1]))
