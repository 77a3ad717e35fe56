"""The receiver's clock of a simulation: two random walks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class ClockWalk:
    """White and random-walk frequency noise; the default is a TCXO."""

    offset_m: float = 0.0
    """At the first epoch."""
    drift_m_s: float = 0.0
    """At the first epoch."""
    phase_m2_s: float = 0.01
    """Spectral density of the white frequency noise, m^2/s."""
    frequency_m2_s3: float = 0.0004
    """Spectral density of the random walk of the frequency, (m/s)^2/s."""

    def draw(
        self, random: np.random.Generator, epochs: int, interval_s: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Offset in m and drift in m/s at each epoch, (E,) each.

        Over an interval T the noise of both has the covariance [[p T + q T^3/3, q T^2/2],
        [q T^2/2, q T]].
        """
        first, second = random.standard_normal((2, max(epochs - 1, 0)))
        q, length = self.frequency_m2_s3, interval_s
        drift_noise = np.sqrt(q * length) * first
        alone = np.sqrt(self.phase_m2_s * length + q * length**3 / 12)
        drift = self.drift_m_s + _walk(drift_noise)
        steps = length * drift[:-1] + 0.5 * length * drift_noise + alone * second
        return self.offset_m + _walk(steps), drift


IDEAL = ClockWalk(phase_m2_s=0.0, frequency_m2_s3=0.0)
"""A clock that is right."""


def _walk(steps: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([[0.0], np.cumsum(steps)])
