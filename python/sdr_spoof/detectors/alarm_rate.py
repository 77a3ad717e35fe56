"""False alarms per hour of a test that slides over white noise.

Neighbouring windows share most of their rows, so crossings of a threshold come in clumps; what is
heard as an alarm is a clump. The two standardised components u of a window (jump, slope) are a
Gaussian process whose autocorrelation falls linearly from lag 0, along the unit vector e by
beta(e) a row. For such a process the rate of clumps with |u|^2 > T is, per row and for high T,

    p T < beta(e) nu(sqrt(2 beta(e) T)) >    with p = exp(-T / 2), mean over all directions e

(Siegmund, *Sequential Analysis*, 1985, chapters 4 and 8 and appendix; Aldous, *Probability
Approximations via the Poisson Clumping Heuristic*, 1989, section J: beta T p in continuous time; nu
corrects for testing at whole rows, and turns the rate into p a row where rows hardly overlap). The
factor beside p is thus the number of independent tests that the sliding amounts to. Rates of
several lengths of window are added: an upper bound, since their windows overlap too.

A test of one component, the mean of a window against that of a reference, is the same in one
dimension: |u| > z comes at 2 z phi(z) beta nu(z sqrt(2 beta)) a row, phi the normal density. What
counts is the correlation from row to row, which a monotone transform of the statistic hardly
changes: the quotient of two sample variances, as the normal quantile of its F law, keeps it too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

DIRECTIONS = 64
"""Directions over which the mean is taken, over half a turn."""
LEAST_SIGMAS = 2.0
"""Below, the law of high thresholds does not hold; nobody may ask for so many alarms."""


def threshold_sigmas(
    windows: Sequence[int], reference: int, step_s: float, false_alarms_per_hour: float
) -> float:
    """Threshold on the equivalent normal deviate for a rate of false alarms.

    ``windows`` and ``reference`` are lengths in rows of ``step_s``. The deviate z of an energy T
    is that of the same two-sided probability: P(|N(0, 1)| > z) = exp(-T / 2).
    """
    return _threshold(tuple(windows), reference, step_s, false_alarms_per_hour)


@lru_cache(maxsize=256)
def _threshold(
    windows: tuple[int, ...], reference: int, step_s: float, false_alarms_per_hour: float
) -> float:
    def excess(z: float) -> float:
        return float(np.log(alarms_per_hour(z, windows, reference, step_s) / false_alarms_per_hour))

    return LEAST_SIGMAS if excess(LEAST_SIGMAS) < 0.0 else _zero(excess)


def mean_threshold_sigmas(
    window: int, reference: int, step_s: float, false_alarms_per_hour: float, sides: int = 2
) -> float:
    """Threshold in standard deviations of a mean against that of the reference before it.

    Lengths as in :func:`threshold_sigmas`; ``sides`` is 1 where only a rise alarms.
    """
    return _mean_threshold(window, reference, step_s, 2.0 * false_alarms_per_hour / sides)


@lru_cache(maxsize=256)
def _mean_threshold(
    window: int, reference: int, step_s: float, false_alarms_per_hour: float
) -> float:
    def excess(z: float) -> float:
        rate = mean_alarms_per_hour(z, window, reference, step_s)
        return float(np.log(rate / false_alarms_per_hour))

    return LEAST_SIGMAS if excess(LEAST_SIGMAS) < 0.0 else _zero(excess)


def mean_alarms_per_hour(z: float, window: int, reference: int, step_s: float) -> float:
    """Rate of clumps of means beyond ``z`` standard deviations to either side, per hour."""
    # The autocorrelation of the weights falls by half the squares of their steps.
    ends, middle = 1.0 / window**2 + 1.0 / reference**2, (1.0 / window + 1.0 / reference) ** 2
    loss = 0.5 * (ends + middle) / (1.0 / window + 1.0 / reference)
    per_row = 2.0 * z * loss * overshoot(z * np.sqrt(2.0 * loss)) * _density(z)
    return 3600.0 / step_s * float(per_row)


def alarms_per_hour(z: float, windows: Sequence[int], reference: int, step_s: float) -> float:
    """Rate of clumps of tests beyond the equivalent normal deviate ``z``, per hour of tests."""
    log_p = float(scipy.special.log_ndtr(-z)) + np.log(2.0)
    return tests_per_hour(z, windows, reference, step_s) * float(np.exp(log_p))


def tests_per_hour(z: float, windows: Sequence[int], reference: int, step_s: float) -> float:
    """Independent tests per hour that all windows together amount to, at the deviate ``z``."""
    energy = -2.0 * (float(scipy.special.log_ndtr(-z)) + np.log(2.0))
    per_row = sum(min(_tests_per_row(energy, n, reference), 1.0) for n in windows)
    return 3600.0 / step_s * per_row


def _tests_per_row(energy: float, window: int, reference: int) -> float:
    loss = correlation_loss(window, reference)
    return float(np.mean(energy * loss * overshoot(np.sqrt(2.0 * loss * energy))))


@lru_cache(maxsize=256)
def correlation_loss(window: int, reference: int) -> NDArray[np.float64]:
    """One minus the autocorrelation from one row to the next, by direction of (jump, slope)."""
    jump = np.concatenate([np.full(reference, -1.0 / reference), np.full(window, 1.0 / window)])
    slope = np.concatenate([np.zeros(reference), np.arange(window) - (window - 1) / 2.0])
    weights = np.vstack([jump / np.linalg.norm(jump), slope / np.linalg.norm(slope)])
    next_row = weights[:, 1:] @ weights[:, :-1].T
    angle = np.arange(DIRECTIONS) * (np.pi / DIRECTIONS)
    direction = np.vstack([np.cos(angle), np.sin(angle)])
    return np.asarray(1.0 - np.einsum("id,ij,jd->d", direction, next_row, direction))


def overshoot(x: ArrayLike) -> NDArray[np.float64]:
    """Siegmund's nu(x), 1 at 0 and 2 / x^2 for large x.

    Approximation of Siegmund and Yakir (*The Statistics of Gene Mapping*, 2007, equation 5.2).
    """
    half = np.asarray(x, dtype=np.float64) / 2.0
    above = scipy.special.ndtr(half)
    return np.asarray((above - 0.5) / half / (half * above + _density(half)))


def _density(x: ArrayLike) -> NDArray[np.float64]:
    """Of the standard normal law."""
    return np.asarray(np.exp(-0.5 * np.square(x)) / np.sqrt(2.0 * np.pi))


def _zero(excess: Callable[[float], float]) -> float:
    """Standard deviations at which it is zero."""
    return float(scipy.optimize.brentq(excess, 2.0, 30.0))
