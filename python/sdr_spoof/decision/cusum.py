"""Page's cumulative sum to both sides: the likelihood ratio of one given shift since any onset.

S_k = max(0, S_(k-1) + d z_k - d^2 / 2) for a shift of d standard deviations, and for -d; the larger
of both is the statistic (E. S. Page, Continuous inspection schemes, Biometrika 41, 1954). Of all
rules with the same rate of false alarms it finds that shift soonest in the worst case (Moustakides
1986), and how soon does not depend on when it begins.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.detectors.config import DetectionConfig


@dataclass(frozen=True)
class Parameters:
    """For which shift."""

    shift: float = 1.5
    """In standard deviations."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("cusum", shift=(self.shift, 1e-3))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The larger of both sums, in log-likelihood."""
    return by_rows(lambda rows: _core.cusum_path(rows, [parameters.shift]), z)


def _configured(parameters: Parameters, config: DetectionConfig) -> Parameters:
    return replace(parameters, shift=config.rule_shift_sigmas)


RULE = SequentialRule(
    "cusum",
    "Cumulative sum",
    "whether the mean has shifted by a given amount at any time",
    path,
    Parameters(),
    lambda parameters: Change(shifts=(parameters.shift,)),
    configured=_configured,
)
