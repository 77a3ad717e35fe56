"""Shares that are counted: their Wilson intervals."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Z_95 = 1.959964
"""Standard errors of a two-sided 95 % interval: error bars in figures."""
Z_ACCEPTED = 4.0
"""Standard errors within which a count must agree with theory."""


def wilson(
    hits: ArrayLike, trials: ArrayLike, z: float = Z_95
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Interval of a probability of which ``hits`` of ``trials`` were counted.

    Source: E. B. Wilson, Probable inference, the law of succession, and statistical inference,
    J. Am. Stat. Assoc. 22 (1927). Without trials the interval is 0 to 1.
    """
    n = np.maximum(np.asarray(trials, dtype=np.float64), 1e-12)
    share = np.asarray(hits, dtype=np.float64) / n
    middle = (share + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * np.sqrt(share * (1 - share) / n + z**2 / (4 * n**2))
    low = np.where(share <= 0.0, 0.0, middle - half)
    high = np.where(share >= 1.0, 1.0, middle + half)
    return np.clip(low, 0.0, 1.0), np.clip(high, 0.0, 1.0)
