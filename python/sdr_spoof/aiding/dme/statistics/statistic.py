"""A registered statistic."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.geometry import Geometry


@dataclass(frozen=True)
class Statistic:
    """A linear statistic; H0: each channel ~ N(0, 1)."""

    name: str
    title: str
    tests: str
    """What is tested, in words for the report."""
    blind_to: str
    """What it cannot see, in words for the report."""
    weights: Callable[[Geometry], NDArray[np.float64]]
    """From m differences to C channels, (C, m); raises AidingError where the geometry does not
    give any."""
    by_satellite: bool
    """Whether channel j is satellite j."""

    def values(self, differences_m: NDArray[np.float64], geometry: Geometry) -> NDArray[np.float64]:
        """Channels (..., C) of differences (..., m)."""
        return np.asarray(differences_m @ self.weights(geometry).T)


def normalised(weights: NDArray[np.float64], geometry: Geometry) -> NDArray[np.float64]:
    """Weights with unit variance in each channel."""
    spread = np.linalg.norm(weights * geometry.sigma_m, axis=1)
    return np.asarray(weights / spread[:, None])
