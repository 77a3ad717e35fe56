"""Amplitude and noise of soft symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SURPRISE = 1e-8
"""Chance, word by word, of something other than Gaussian noise: a half-cycle slip, interference."""


def doubt(costs: NDArray[np.float64], noise: float) -> NDArray[np.float64]:
    """Probability (N,) that the cheapest of several explanations (N, K) of a word is wrong.

    A cost is the sum of the magnitudes of the symbols of amplitude 1 that would be wrong: in noise
    of variance s^2, errors of cost c have the weight exp(-2 c / s^2).
    """
    least = costs.min(axis=1, initial=np.inf)
    exponents = -2.0 * (costs - least[:, None]) / noise**2
    others = np.exp(np.maximum(exponents, -700.0)).sum(axis=1) - 1.0
    others += SURPRISE * np.exp(np.minimum(2.0 * least / noise**2, 700.0))
    return np.asarray(others / (1.0 + others))


def amplitude_and_noise(values: NDArray[np.float32]) -> tuple[float, float]:
    """Amplitude, and standard deviation of the noise, of symbols +-A in Gaussian noise.

    From the second and fourth moments: M2 = A^2 + s^2, 3 M2^2 - M4 = 2 A^4. Missing ones (0) are
    left out. Without any signal the amplitude is 0.
    """
    present = values[values != 0].astype(np.float64)
    if not present.size:
        return 0.0, 1.0
    second, fourth = float(np.mean(present**2)), float(np.mean(present**4))
    power = min(np.sqrt(max(3 * second**2 - fourth, 0.0) / 2), second)
    return float(np.sqrt(power)), float(np.sqrt(second - power))
