"""Detection threshold of the FFT search for a false-alarm probability over its whole grid.

In noise a cell of the grid (power of K coherent integrations, in units of half the mean) follows
the chi-square law of 2K degrees of freedom. The cells are not independent: the next delay cell
shares the code's autocorrelation, the next Doppler cell sinc(1/2). Exceedances therefore come in
clumps, and it is clumps that follow a Poisson law (D. Aldous, "Probability Approximations via the
Poisson Clumping Heuristic", chapter A). The number of clumps expected is::

    cells * P(X > u) * P(the next cells in delay do not exceed) * P(those in Doppler do not)

A cell Y whose amplitude is correlated by rho with a cell X = x follows
``Y / (1 - rho^2) ~ noncentral chi-square(2K, rho^2 x / (1 - rho^2))``; averaged over x > u.
The probability over a recording with S searches is at most S times that of one search.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

DOPPLER_CORRELATION = (2 / np.pi,)
"""Correlation of Doppler cells 1/(2T) apart: sinc(1/2). It is 0 for the next but one."""
LEAST_P = 1e-35


@lru_cache(maxsize=256)
def threshold(
    pfa: float, bins: int, lags: int, blocks: int, delay_correlation: tuple[float, ...]
) -> float:
    """Threshold that noise exceeds anywhere in a grid with probability ``pfa``.

    Args:
        pfa: false-alarm probability of one search (one PRN), in (0, 1).
        bins: Doppler bins, 1/(2T) apart.
        lags: delay cells; the delay wraps.
        blocks: non-coherent sums K.
        delay_correlation: amplitude correlation with the 1st, 2nd ... next delay cell.
    """
    wanted = np.log(-np.log1p(-pfa))
    single = float(scipy.special.chdtri(2 * blocks, min(2 * pfa, 0.99)))
    union = float(scipy.special.chdtri(2 * blocks, pfa / (bins * lags) / 2))

    def excess(level: float) -> float:
        return float(np.log(expected_clumps(level, bins, lags, blocks, delay_correlation)) - wanted)

    return float(scipy.optimize.brentq(excess, single, union, xtol=1e-6))


def log10_probability(
    level: float, bins: int, lags: int, blocks: int, delay_correlation: tuple[float, ...]
) -> float:
    """log10 of the probability that noise exceeds ``level`` anywhere; arguments as above.

    Not below that of ``LEAST_P`` in a single cell, beyond which no law is trusted.
    """
    level = min(level, float(scipy.special.chdtri(2 * blocks, LEAST_P)))
    clumps = expected_clumps(level, bins, lags, blocks, delay_correlation)
    return float(np.log10(-np.expm1(-clumps)))


def expected_clumps(
    level: float, bins: int, lags: int, blocks: int, delay_correlation: tuple[float, ...]
) -> float:
    """Expected number of clumps of cells above ``level`` in noise; arguments as above."""
    delay_free = _none_follows(level, blocks, delay_correlation)
    doppler_free = _none_follows(level, blocks, DOPPLER_CORRELATION)
    cells = max(1.0, lags * delay_free) * (1 + (bins - 1) * doppler_free)
    return float(cells * scipy.special.chdtrc(2 * blocks, level))


def _none_follows(level: float, blocks: int, correlation: tuple[float, ...]) -> float:
    """Probability that no following cell exceeds ``level``, given that one does."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    share = (nodes + 1) / 2
    freedom = 2 * blocks
    above = scipy.special.chdtri(freedom, scipy.special.chdtrc(freedom, level) * share)
    below = np.ones_like(above)
    for rho in correlation:
        rest = 1 - rho**2
        below *= scipy.special.chndtr(level / rest, freedom, rho**2 * above / rest)
    return float(np.sum(weights * below) / 2)
