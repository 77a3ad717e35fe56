"""Noise of a receiver's measurements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class ReceiverNoise:
    """Standard deviations, independent from satellite to satellite.

    The defaults of code and rate are those of the ship's study; 2 mm of carrier phase are a 10 Hz
    loop at 45 dB-Hz and a little multipath.
    """

    code_white_m: float = 1.0
    code_markov_m: float = 1.5
    """Of multipath and what models leave: a first-order Gauss-Markov process."""
    code_markov_s: float = 200.0
    """Its correlation time."""
    carrier_m: float = 0.002
    """White noise of the phase; changes from epoch to epoch have the sum of two: MA(1)."""
    rate_m_s: float = 0.05

    def code_m(
        self, random: np.random.Generator, shape: tuple[int, ...], interval_s: float
    ) -> NDArray[np.float64]:
        """Of pseudoranges (E, S)."""
        white = self.code_white_m * random.standard_normal(shape)
        return white + self._markov_m(random, shape, interval_s)

    def phase_m(self, random: np.random.Generator, shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Of carrier phases (E, S)."""
        return self.carrier_m * random.standard_normal(shape)

    def doppler_m_s(
        self, random: np.random.Generator, shape: tuple[int, ...]
    ) -> NDArray[np.float64]:
        """Of rates (E, S)."""
        return self.rate_m_s * random.standard_normal(shape)

    def _markov_m(
        self, random: np.random.Generator, shape: tuple[int, ...], interval_s: float
    ) -> NDArray[np.float64]:
        """Stationary from the first epoch on."""
        drive = random.standard_normal(shape)
        keep = np.exp(-interval_s / self.code_markov_s)
        drive[1:] *= np.sqrt(1 - keep**2)
        return self.code_markov_m * np.asarray(lfilter([1.0], [1.0, -keep], drive, axis=0))


SILENT = ReceiverNoise(0.0, 0.0, 200.0, 0.0, 0.0)
"""No noise at all."""
