"""Noise level of a series, measured from its own past and robust against what disturbs it.

The rows are cut into groups, a line is taken out of each, and the residual variances of the groups
before a row are reduced to their median: neither a slow course nor a disturbance of up to half of
the groups matters. Law under white Gaussian noise: a group of g rows gives a chi-square variable of
g - 2 degrees of freedom; the median of k of them, freed from its bias, has for large k the relative
variance 1 / (4 k (q f(q))^2), q the median of that law and f its density there (David and Nagaraja,
*Order Statistics*, 2003, section 10.2). It is treated as a chi-square variable of the same relative
variance, nu = 8 k (q f(q))^2 degrees of freedom: 4.7 of the 8 that a group of ten rows has.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray


@dataclass(frozen=True)
class NoiseLevel:
    """Variance of a row by group; a row may use the groups that end before it."""

    variance: NDArray[np.float64]
    """From this group and those before it; NaN while too few, shape (groups,)."""
    relative: NDArray[np.float64]
    """The same of variances over what was expected, shape (groups,)."""
    freedom: NDArray[np.float64]
    """Degrees of freedom of that variance."""
    skip: int
    """Rows before the first group."""
    group: int

    def before(
        self, row: NDArray[np.int64], spread: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Variance and its degrees of freedom from whole groups before each row; NaN for none.

        Not below what the spread expected of the test itself makes of it: where C/N0 falls, noise
        rises at once.
        """
        last = (row - self.skip) // self.group - 1
        known = last >= 0
        last = np.where(known, last, 0)
        variance = np.maximum(self.variance[last], self.relative[last] * spread)
        return np.where(known, variance, np.nan), self.freedom[last]


def noise_level(
    values: NDArray[np.float64],
    spread: NDArray[np.float64],
    group: int,
    longest: int,
    least: int,
    first: int = 0,
) -> NoiseLevel:
    """Trailing noise level of ``values`` over ``least`` to ``longest`` rows.

    ``spread`` is the variance that is expected of each row, up to a factor. Groups begin at
    multiples of ``group`` of the track's rows, of which ``first`` is the number of the first here.
    """
    skip = -first % group
    inside = slice(skip, skip + (values.size - skip) // group * group)
    blocks = values[inside].reshape(-1, group)
    line, _ = np.linalg.qr(np.vander(np.arange(group, dtype=np.float64), 2))
    centred = blocks - blocks[:, :1]
    residual = centred - (centred @ line) @ line.T
    each = np.sum(residual**2, axis=1)
    # A group may be cut off at the beginning.
    most, fewest = longest // group, max(least // group - 1, 3)
    count = np.minimum(np.arange(each.size) + 1, most).astype(np.float64)
    middle, density = _chi2_median(group - 2)
    expected = spread[inside].reshape(-1, group).mean(axis=1)
    variance, relative = (_trailing_median(v, most) / middle for v in (each, each / expected))
    variance[: fewest - 1] = np.nan
    freedom = np.maximum(8.0 * count * (middle * density) ** 2, 1.0)
    return NoiseLevel(variance, relative, freedom, skip, group)


@cache
def _chi2_median(freedom: int) -> tuple[float, float]:
    """Median of the chi-square law, and its density there."""
    half = 0.5 * freedom
    middle = 2.0 * float(scipy.special.gammaincinv(half, 0.5))
    log_density = (half - 1.0) * np.log(0.5 * middle) - 0.5 * middle - scipy.special.gammaln(half)
    return middle, 0.5 * float(np.exp(log_density))


def _trailing_median(values: NDArray[np.float64], most: int) -> NDArray[np.float64]:
    """Median of each value and up to ``most`` - 1 before it."""
    # What is not there yet sorts behind everything else.
    padded = np.concatenate([np.full(most - 1, np.inf), values])
    ordered = np.sort(sliding_window_view(padded, most), axis=1)
    count = np.minimum(np.arange(values.size) + 1, most)
    rows = np.arange(values.size)
    return np.asarray(0.5 * (ordered[rows, (count - 1) // 2] + ordered[rows, count // 2]))
