"""How many epochs a test needs: the step that asks for more samples until the power is enough.

A mean over K epochs of differenced phase, sigma the deviation of one change, has the noise
sigma / K (MA(1), correlation -1/2: all but the first and the last phase cancel); independent
samples have sigma / sqrt(K). What an INS is off by does not average. Declared is only where the
achieved probability of detection *reaches* the required one; the publication prints the inequality
the other way round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.stats import nct, norm, t

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

Law = Literal["differenced", "independent"]


def mean_sigma(sigma: ArrayLike, samples: ArrayLike, law: Law = "differenced") -> Floats:
    """Noise of a mean over so many samples, of which one has ``sigma``."""
    count = np.asarray(samples, np.float64)
    return np.asarray(np.asarray(sigma) / (count if law == "differenced" else np.sqrt(count)))


def power(drag: ArrayLike, sigma: ArrayLike, pfa: float) -> Floats:
    """Probability that |N(drag, sigma)| exceeds its two-sided threshold."""
    size = np.abs(np.asarray(drag)) / np.asarray(sigma)
    threshold = float(norm.isf(pfa / 2))
    return np.asarray(norm.sf(threshold - size) + norm.cdf(-threshold - size))


def t_power(drag: float, sigma: float, samples: int, pfa: float) -> float:
    """The same of Student's t over independent samples of unknown deviation."""
    threshold, freedom = float(t.isf(pfa / 2, samples - 1)), samples - 1
    centre = abs(drag) / sigma * np.sqrt(samples)
    return float(nct.sf(threshold, freedom, centre) + nct.cdf(-threshold, freedom, centre))


def fewest(
    drag: float,
    noise: ArrayLike,
    drift: ArrayLike,
    pfa: float,
    pd: float,
    most: int,
    law: Law = "differenced",
) -> NDArray[np.int64]:
    """Fewest samples whose mean finds a drag with probability ``pd``; 0 where ``most`` do not.

    Args:
        drag: to be found.
        noise: deviation of one sample, (...).
        drift: deviation of what does not average, the INS, (...).
        pfa: of one two-sided test.
        pd: required.
        most: samples in a mean.
        law: how the noise averages.
    """
    noise, drift = np.broadcast_arrays(np.asarray(noise, float), np.asarray(drift, float))
    found = np.zeros(noise.shape, np.int64)
    for samples in range(most, 0, -1):
        sigma = np.hypot(mean_sigma(noise, samples, law), drift)
        found = np.where(power(drag, sigma, pfa) >= pd, samples, found)
    return found


def fewest_for_t(drag: float, sigma: float, pfa: float, pd: float, most: int = 1000) -> int:
    """Fewest independent samples of a t-test, 0 if ``most`` are not enough."""
    for samples in range(2, most + 1):
        if t_power(drag, sigma, samples, pfa) >= pd:
            return samples
    return 0
