"""Whether two signals come from one antenna: classical double difference between satellites.

Signals of one transmitter have the same phase differences whatever the array's attitude; those of
two satellites do not. It needs two spoofed signals or more from one antenna and is blind where each
comes from its own, or where a single one is spoofed; it is here for comparison.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtri

from .geometry import shared_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def statistic(difference_cycles: Floats, sigma_cycles: float) -> Floats:
    """Distance of every pair of signals, (..., S, S): chi-square with A - 1 if they are one source.

    Args:
        difference_cycles: phase differences of S signals at one epoch, (..., S, A - 1).
        sigma_cycles: noise of one antenna's phase.
    """
    apart = difference_cycles[..., :, None, :] - difference_cycles[..., None, :, :]
    apart = apart - np.round(apart)
    weights = np.linalg.inv(2 * sigma_cycles**2 * shared_noise(apart.shape[-1]))
    return np.asarray(np.einsum("...i,ij,...j->...", apart, weights, apart))


def one_source(
    difference_cycles: Floats, sigma_cycles: float, missed: float = 0.01
) -> NDArray[np.bool_]:
    """Signals (..., S) that share their direction with another one.

    Args:
        difference_cycles: as of :func:`statistic`.
        sigma_cycles: as of :func:`statistic`.
        missed: probability that a pair from one antenna is not seen as such.
    """
    close = statistic(difference_cycles, sigma_cycles) <= chdtri(
        difference_cycles.shape[-1], missed
    )
    close &= ~np.eye(close.shape[-1], dtype=bool)
    return np.asarray(close.any(axis=-1))
