"""Which satellites are spoofed, and where the fix is without them.

Looked for is the smallest set of satellites without which the means of the differences over a
window agree: with each other and one clock where the INS is trusted, or with any position where it
is not (RAIM). Of sets as small, the one that leaves least. Where too many are spoofed, or a
smaller set of spoofed ones agrees among itself, no measurement can tell; with a trusted INS all
but two may be spoofed.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from sdr_spoof.errors import AidingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .geometry import Geometry

AGREE = 1e-3
"""Probability with which satellites that are as they should be are found not to agree."""
LEAST_MARGIN = 1e-3
"""A set must be so much likelier than another of its size, as a ratio of likelihoods."""


@dataclass(frozen=True)
class Isolation:
    """What was found, and what it means for the position."""

    satellites: tuple[int, ...] | None
    """Those to be left out, ascending; None where no set explains the differences."""
    before_m: NDArray[np.float64] | None
    """Error of the inertial position by all satellites, east, north, up: how far the fix is from
    where the INS says; None without a fix."""
    after_m: NDArray[np.float64] | None
    """Likewise, without those that are left out."""
    unique: bool
    """Whether no other set of the same size explains them as well."""


def isolate(
    differences_m: NDArray[np.float64],
    geometry: Geometry,
    epochs: int = 1,
    *,
    trusted: bool = True,
    expected: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
) -> Isolation:
    """From means of differences over some epochs, (m,).

    Args:
        differences_m: predicted less measured, satellites and then stations; NaN where one is
            missing.
        geometry: of the window's middle.
        epochs: that were averaged.
        trusted: whether the INS is known not to be captured.
        expected: error of the INS by itself, east, north, up (3,), and its covariance (3, 3);
            none if not given.
    """
    error_m, error_m2 = (np.zeros(3), np.zeros((3, 3))) if expected is None else expected
    free = epochs * error_m2 if trusted else None
    rows = np.isfinite(differences_m[: geometry.satellites])
    known = [int(j) for j in np.flatnonzero(rows)]
    mean = (differences_m - geometry.design[:, :3] @ error_m) * np.sqrt(epochs)
    for size in range(len(known)):
        fits = []
        for left_out in combinations(known, size):
            kept = [j for j in known if j not in left_out]
            found = _misfit(mean, geometry, kept, free)
            if found is not None and found[0] <= chi2.isf(AGREE, found[1]):
                fits.append((found[0], left_out))
        if fits:
            fits.sort()
            unique = len(fits) == 1 or fits[1][0] - fits[0][0] > -2.0 * np.log(LEAST_MARGIN)
            return _isolation(differences_m, geometry, known, fits[0][1], unique)
    return _isolation(differences_m, geometry, known, None, False)


def _misfit(
    mean: NDArray[np.float64],
    geometry: Geometry,
    kept: list[int],
    error_m2: NDArray[np.float64] | None,
) -> tuple[float, int] | None:
    """Sum of squares that no clock and no error of the INS explains, and its degrees of freedom.

    The INS is wrong by as much as a covariance allows, or by anything (None).
    """
    unknown = [3] if error_m2 is not None else [0, 1, 2, 3]
    freedom = len(kept) - len(unknown)
    if freedom < 1:
        return None
    place = geometry.design[kept, :3]
    total = np.diag(geometry.sigma_m[kept] ** 2)
    if error_m2 is not None:
        total = total + place @ error_m2 @ place.T
    root = np.linalg.cholesky(total)
    design = np.linalg.solve(root, geometry.design[np.ix_(kept, unknown)])
    z = np.linalg.solve(root, mean[kept])
    residual = z - design @ np.linalg.lstsq(design, z, rcond=None)[0]
    return float(residual @ residual), freedom


def _isolation(
    differences_m: NDArray[np.float64],
    geometry: Geometry,
    known: list[int],
    left_out: tuple[int, ...] | None,
    unique: bool,
) -> Isolation:
    kept = [j for j in known if j not in (left_out or ())]
    before, after = (_fix(differences_m, geometry, rows) for rows in (known, kept))
    return Isolation(left_out, before, after if left_out is not None else None, unique)


def _fix(
    differences_m: NDArray[np.float64], geometry: Geometry, rows: list[int]
) -> NDArray[np.float64] | None:
    """Least squares of some satellites alone; None where they do not give a position."""
    others = tuple(j for j in range(geometry.satellites) if j not in rows)
    gnss = geometry.without_stations().without(others)
    try:
        return np.asarray(gnss.estimator()[:3] @ differences_m[rows])
    except AidingError:
        return None
