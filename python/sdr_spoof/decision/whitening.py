"""Whether samples are what a rule is calibrated for, and what can be done where they are not.

A sequential rule adds up samples as if they were independent. Where each remembers the one before
(receiver noise that is smoothed, multipath, an inertial reference that is corrected) the sum
wanders much further: with a correlation of 0.9 from sample to sample every rule alarms within the
hour. One coefficient of memory can be measured before the tests begin and taken out,

    e_k = (z_k - rho z_(k-1)) / sqrt(1 - rho^2),

at a price: a steady shift shrinks by sqrt((1 - rho) / (1 + rho)). Whoever is more coloured than
that, or louder than the law says, is not judged.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from sdr_spoof.decision.record import Refusal

if TYPE_CHECKING:
    from numpy.typing import NDArray

LEAST_SAMPLES = 20
"""Fewest samples from which memory and scatter can be told."""
LAGS = 10
"""Autocorrelations that are looked at."""
SIGNIFICANT = 3.0
"""Standard errors from which on a memory is believed, and taken out."""
MOST_RHO = 0.95
"""Beyond, little would be left of any shift."""
REFUSED = 1e-4
"""Probability with which samples as they should be are refused, by each of both tests."""


@dataclass(frozen=True)
class Fit:
    """What the samples before the tests are like."""

    rho: float
    """Coefficient of memory that is to be taken out; 0 where none is significant."""
    refusal: Refusal | None


def fit(z: NDArray[np.float64]) -> Fit:
    """Memory of samples in standard deviations, shape (N,), and whether a rule may judge them.

    Samples that are missing (NaN) are left out.
    """
    z = z[np.isfinite(z)]
    if z.size < LEAST_SAMPLES:
        return Fit(
            0.0,
            Refusal(
                f"{z.size} independent samples before the tests, {LEAST_SAMPLES} are needed to "
                "tell whether they are white"
            ),
        )
    rho = float(autocorrelation(z, 1)[0])
    if abs(rho) * z.size**0.5 < SIGNIFICANT:
        rho = 0.0
    if abs(rho) > MOST_RHO:
        return Fit(rho, Refusal(f"samples remember the one before by {rho:.2f}, too much to judge"))
    return Fit(rho, _objection(whiten(z, rho)[1:], rho))


def whiten(z: NDArray[np.float64], rho: float) -> NDArray[np.float64]:
    """Take a memory of one sample out of samples of any shape (..., N); the first stays."""
    if rho == 0.0:
        return z
    white = z.copy()
    white[..., 1:] = (z[..., 1:] - rho * z[..., :-1]) / (1.0 - rho**2) ** 0.5
    return white


def shift_left(rho: float) -> float:
    """What whitening leaves of a steady shift, as a share of it."""
    return float(((1.0 - rho) / (1.0 + rho)) ** 0.5)


def autocorrelation(z: NDArray[np.float64], lags: int) -> NDArray[np.float64]:
    """Autocorrelation about the mean from lag 1 on, shape (..., lags)."""
    about = z - z.mean(-1, keepdims=True)
    power = (about**2).sum(-1)
    found = [(about[..., k:] * about[..., :-k]).sum(-1) for k in range(1, lags + 1)]
    return np.asarray(np.stack(found, -1) / np.maximum(power, 1e-300)[..., None])


def _objection(white: NDArray[np.float64], rho: float) -> Refusal | None:
    """Ljung and Box's test of what colour is left, and one of the scatter."""
    n = white.size
    lag = np.arange(1, LAGS + 1)
    box = n * (n + 2.0) * float((autocorrelation(white, LAGS) ** 2 / (n - lag)).sum())
    if chi2.sf(box, LAGS - (rho != 0.0)) < REFUSED:
        return Refusal(
            f"samples are coloured beyond a memory of one (rho {rho:.2f}): the rule is not "
            "calibrated for them"
        )
    if chi2.sf(float((white**2).sum()), n) < REFUSED:
        return Refusal(
            f"samples scatter {float((white**2).mean()) ** 0.5:.2f} times as much as their law "
            "says: the rule is not calibrated for them"
        )
    return None
