"""Wald's sequential test as published: a shift that was there from the first sample.

The statistic is k m_k^2 / (2 v_k) with the mean m_k and variance v_k of all samples so far
(equations 14 and 17 of the INS/DME publication; A. Wald, *Sequential Analysis*, 1947). Since every
sample before the attack counts against it, the delay grows as the square root of the onset. It has
no lower threshold: without an attack it never decides, it goes on.

With the variance estimated, two samples that happen to agree raise it at once (at the published
threshold with a probability of 0.18): nothing is tested within the first ``guard`` samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Variance = Literal["known", "sample", "as-printed"]
"""One; that of the samples so far (equation 14); by the printed recursion (equation 18)."""

SINCE_START = (0.08, 0.12, 0.18, 0.27, 0.4, 0.6, 0.9, 1.35, 2.0)
"""Shifts since the first sample that carry the statistic to its threshold within an hour."""


@dataclass(frozen=True)
class Parameters:
    """Where the variance comes from, and how many samples are not tested."""

    variance: Variance = "known"
    guard: int = 10
    """First samples within which nothing is tested."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("sprt-classic", guard=(self.guard, 0))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The log-likelihood ratio; zero within the guard."""
    of = parameters
    return by_rows(lambda rows: _core.sprt_path(rows, "classic", of.variance, 1.0, of.guard), z)


RULE = SequentialRule(
    "sprt-classic",
    "Classic sequential test",
    "whether the mean of all samples since the first is zero",
    path,
    Parameters(),
    lambda _: Change(shifts=SINCE_START, from_start=True),
    forgets=False,
)
