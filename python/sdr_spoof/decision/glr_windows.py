"""Generalised likelihood ratio of a shift of any size over the last samples, in several windows.

The statistic is the largest of (sum of the last n samples)^2 / (2 n) over the windows n: the
log-likelihood ratio of a shift that began n samples ago, with its most likely size (A. Willsky and
H. Jones, A generalized likelihood ratio approach to the detection and estimation of jumps in linear
systems, 1976; windows in ratio to each other: Lai 1995). Windows that reach back before the first
sample are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.decision.rule import Change, SequentialRule, by_rows, checked

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

TYPICAL_LEVEL = 12.0
"""Log-likelihood at which windows are compared when samples are drawn for calibration."""


@dataclass(frozen=True)
class Parameters:
    """Over which windows."""

    windows: tuple[int, ...] = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
    """In samples."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("glr-windows", window=(min(self.windows, default=0), 1))


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The largest log-likelihood ratio of all windows."""
    return by_rows(lambda rows: _core.glr_path(rows, parameters.windows), z)


def change(parameters: Parameters) -> Change:
    """Shifts that every other window would find."""
    windows = sorted(parameters.windows)[::2]
    return Change(shifts=tuple((2.0 * TYPICAL_LEVEL / n) ** 0.5 for n in windows))


RULE = SequentialRule(
    "glr-windows",
    "Likelihood ratio over windows",
    "whether the mean has shifted by any amount within the longest window",
    path,
    Parameters(),
    change,
)
