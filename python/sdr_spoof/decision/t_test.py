"""Student's t over a window: the mean of the last K samples over its standard error.

With known variance it is the normal test of the same window. The mean under H0 must be zero: a
drift of what is tested counts as a shift, see :mod:`.local_mean`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

TYPICAL_T = 10.0
"""For which samples are drawn for calibration."""


@dataclass(frozen=True)
class Parameters:
    """Over which window, and whether the variance is known."""

    window: int = 10
    """In samples."""
    variance: Literal["known", "sample"] = "sample"
    """Of the samples themselves, or one."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("t-test", window=(self.window, 2))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """Size of t; zero until the window is full."""
    known = parameters.variance == "known"
    return by_rows(lambda rows: _core.student_path(rows, parameters.window, known), z)


def change(parameters: Parameters) -> Change:
    """A shift of the mean; where the variance is that of the samples, a smaller scatter too.

    Of all normal samples with the same t, the least unlikely have the mean and the standard
    deviation that are used here.
    """
    n = parameters.window
    if parameters.variance == "known":
        return Change(template=(n**-0.5,) * n, sizes=(3.5, 5.0, 7.0))
    ratio = TYPICAL_T / n**0.5
    scale = (1.0 + ratio**2) ** -0.5
    return Change(shifts=(ratio * scale,), scale=scale)


RULE = SequentialRule(
    "t-test",
    "Student's t",
    "whether the mean of the last samples is zero",
    path,
    Parameters(),
    change,
    "deviate",
)
