"""The sequential test with its published compensation, in the reading that works.

The publication adds zeta = ln(K1 E / r) to the statistic with every sample, E = m^2 / (2 v) with
the mean m of all samples (equations 28 to 31). Under H0 that is negative and ever more so, and no
attack is ever found (:mod:`.improved_sprt_as_printed`). Taken from the *current* sample, with the
sum held at zero from below, it gives the published delays:

    S_k = max(0, S_(k-1) + (z m - m^2 / 2) / v + ln(z^2 / (2 v r / K1))).

With the published r / K1 = 1 / 2 the last term is ln(z^2 / v). Since E[z^2] = 1, that is the
log-likelihood ratio of the density z^2 phi(z) to the normal phi(z): the rule is Page's cumulative
sum for samples that avoid zero, whatever their sign, and the first term hardly counts once the mean
has settled. Hence it forgets, and its threshold is that of a cumulative sum; for a steady shift it
is worse than :mod:`.cusum`, most of all for small ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked
from sdr_spoof.decision.sprt_classic import Variance

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Parameters:
    """Compensation, variance, and how many samples are not tested."""

    risk: float = 0.5
    """Risk of taking one more sample over that of a false alarm, r / K1."""
    variance: Variance = "known"
    guard: int = 10
    """First samples within which the sum stays zero."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("improved-sprt", guard=(self.guard, 0), risk=(self.risk, 1e-6))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The sum, never below zero."""
    of = parameters
    return by_rows(lambda rows: _core.sprt_path(rows, "floored", of.variance, of.risk, of.guard), z)


RULE = SequentialRule(
    "improved-sprt",
    "Improved sequential test",
    "whether the samples keep away from zero",
    path,
    Parameters(),
    # Until the mean has settled, a shift counts for more than its squares.
    lambda _: Change(shifts=(1.5, 2.5), energy=True),
)
