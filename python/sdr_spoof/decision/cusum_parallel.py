"""Several cumulative sums at a time, each for another shift; the largest is the statistic.

Each sum is that of :mod:`.cusum`, in log-likelihood, so that one threshold does for all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Parameters:
    """For which shifts."""

    shifts: tuple[float, ...] = (0.5, 1.0, 1.5, 2.5, 4.0)
    """In standard deviations."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("cusum-parallel", shift=(min(self.shifts, default=0.0), 1e-3))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The largest of all sums, in log-likelihood."""
    return by_rows(lambda rows: _core.cusum_path(rows, parameters.shifts), z)


RULE = SequentialRule(
    "cusum-parallel",
    "Parallel cumulative sums",
    "whether the mean has shifted by one of several amounts at any time",
    path,
    Parameters(),
    lambda parameters: Change(shifts=tuple(parameters.shifts)),
)
