"""The sequential test with its published compensation, to the letter: it never alarms.

Equations 14, 17, 18 and 28 to 31 of the INS/DME publication: with every sample,

    S_k = S_(k-1) + (z m - m^2 / 2) / v + ln(m^2 / (2 v r / K1)),

m the mean of all samples so far. The mean shrinks as 1 / sqrt(k), so that the sum of the last term
is -ln k! - 1.27 k without an attack (-1117 after 200 samples, -30458 after 3600), and no attack
lifts it again. For comparison only. Its variance is by the printed recursion (equation 18), which
does not settle at the true one but at a random value of mean 0.645 and standard deviation 0.41.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked
from sdr_spoof.decision.sprt_classic import SINCE_START, Variance

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Parameters:
    """Compensation, variance, and how many samples are not tested."""

    risk: float = 0.5
    """Risk of taking one more sample over that of a false alarm, r / K1."""
    variance: Variance = "as-printed"
    guard: int = 0

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("improved-sprt-as-printed", guard=(self.guard, 0), risk=(self.risk, 1e-6))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The sum as printed."""
    of = parameters
    return by_rows(
        lambda rows: _core.sprt_path(rows, "as-printed", of.variance, of.risk, of.guard), z
    )


RULE = SequentialRule(
    "improved-sprt-as-printed",
    "Improved sequential test as printed",
    "nothing: it never alarms, and is there for comparison",
    path,
    Parameters(),
    lambda _: Change(shifts=SINCE_START, from_start=True),
    forgets=False,
)
