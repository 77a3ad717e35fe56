"""Snapshot tests for comparison: RAIM by least squares with exclusion, and AAIM.

Both are chi-square tests of what least squares leaves over at one epoch: of the pseudoranges alone
(RAIM), or with the INS, through the differences, and DME (AAIM).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from sdr_spoof.errors import AidingError

from .statistics.parity import weights

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .geometry import Geometry


@dataclass(frozen=True)
class Snapshot:
    """What a test says at each epoch."""

    statistic: NDArray[np.float64]
    """Sum of squares, (...)."""
    threshold: float
    excluded: NDArray[np.int64]
    """Satellite that is left out, -1 without an alarm or where none explains it, (...)."""

    @property
    def alarmed(self) -> NDArray[np.bool_]:
        """Where the statistic exceeds the threshold, (...)."""
        return np.asarray(self.statistic > self.threshold)


def raim(differences_m: NDArray[np.float64], geometry: Geometry, pfa: float) -> Snapshot:
    """Of the satellites alone; the differences are (..., m)."""
    n = geometry.satellites
    return _test(differences_m[..., :n], geometry.without_stations(), pfa)


def aaim(differences_m: NDArray[np.float64], geometry: Geometry, pfa: float) -> Snapshot:
    """Of satellites and stations against the INS."""
    return _test(differences_m, geometry, pfa)


def _test(differences_m: NDArray[np.float64], geometry: Geometry, pfa: float) -> Snapshot:
    basis = weights(geometry)
    statistic = ((differences_m @ basis.T) ** 2).sum(-1)
    threshold = float(chi2.isf(pfa, len(basis)))
    excluded = np.full(statistic.shape, -1)
    alarmed = statistic > threshold
    if alarmed.any():
        excluded[alarmed] = _exclusion(differences_m[alarmed], geometry, pfa)
    return Snapshot(statistic, threshold, excluded)


def _exclusion(
    differences_m: NDArray[np.float64], geometry: Geometry, pfa: float
) -> NDArray[np.int64]:
    """Satellite without which the others agree best, -1 where they do not without any."""
    left = np.full((len(differences_m), geometry.satellites), np.inf)
    for j in range(geometry.satellites):
        try:
            basis = weights(geometry.without((j,)))
        except AidingError:
            continue
        rest = np.delete(differences_m, j, axis=-1)
        sums = ((rest @ basis.T) ** 2).sum(-1)
        left[:, j] = sums / chi2.isf(pfa, len(basis))
    best = left.argmin(1)
    return np.where(left.min(1) < 1.0, best, -1)
