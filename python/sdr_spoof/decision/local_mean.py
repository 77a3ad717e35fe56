"""The mean of the last samples against a line through those before: blind to what drifts slowly.

An inertial reference drifts, so that the mean of what is tested is not zero even without an attack.
A line fitted to the ``baseline`` samples before the window and extrapolated to its middle takes the
drift off; the difference has the variance s^2 (1 / K + 1 / B + (B + K)^2 / 4 / S) with
S = B (B^2 - 1) / 12. It sees onsets and ends, not a steady offset: the alarm latches.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Parameters:
    """Window and baseline, in samples."""

    window: int = 10
    baseline: int = 60
    """Before the window."""
    slope: bool = True
    """Whether the line may rise and fall, or is a mean."""
    variance: Literal["known", "sample"] = "known"
    """One, or that of the baseline about its line."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        least = 3 if self.slope or self.variance == "sample" else 1
        checked("local-mean", window=(self.window, 1), baseline=(self.baseline, least))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """Size of the difference over its standard error; zero until the baseline is full."""
    of, known = parameters, parameters.variance == "known"
    return by_rows(
        lambda rows: _core.local_mean_path(rows, of.window, of.baseline, of.slope, known), z
    )


def change(parameters: Parameters) -> Change:
    """The weights of window and baseline themselves."""
    n, m = parameters.window, parameters.baseline
    place = np.arange(m) - (m - 1) / 2.0
    slope = place * (0.5 * (m + n) / float(place @ place)) if parameters.slope else 0.0 * place
    weights = np.concatenate([-1.0 / m - slope, np.full(n, 1.0 / n)])
    return Change(template=tuple(weights / np.linalg.norm(weights)), sizes=(3.5, 5.0, 7.0))


RULE = SequentialRule(
    "local-mean",
    "Local mean",
    "whether the last samples depart from the line through those before them",
    path,
    Parameters(),
    change,
    "deviate",
)
