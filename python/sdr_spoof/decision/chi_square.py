"""Sum of squares over a window: chi-square with as many degrees of freedom as it has samples.

It looks for a change of the samples' energy, to whichever side, and says least of a small shift.
Several statistics at one epoch (the parity vector) are summed by the statistic, not here.
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
    """Over which window."""

    window: int = 1
    """In samples."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("chi-square", window=(self.window, 1))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The sum of squares; zero until the window is full."""
    return by_rows(lambda rows: _core.squares_path(rows, parameters.window), z)


def change(parameters: Parameters) -> Change:
    """Samples that scatter as much as a sum of squares well beyond its mean says."""
    n = parameters.window
    return Change(shifts=(0.0,), scale=((n + 8.0 * (2.0 * n) ** 0.5 + 8.0) / n) ** 0.5)


RULE = SequentialRule(
    "chi-square",
    "Chi-square",
    "whether the samples have more energy than noise explains",
    path,
    Parameters(),
    change,
    "squares",
)
