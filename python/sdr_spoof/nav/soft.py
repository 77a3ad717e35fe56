"""Amplitude and noise of soft symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


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
