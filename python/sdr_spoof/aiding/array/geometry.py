"""Places of the antennas of an array, and what their phase differences tell of a direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_FLAT = 1e-3
"""Share of the array's size below which a dimension of it counts as none."""


@dataclass(frozen=True)
class AntennaArray:
    """Three antennas or more, not in one line; the first is the reference."""

    elements_m: tuple[tuple[float, float, float], ...]
    """Forward, right, down of each."""

    def __post_init__(self) -> None:
        """Refuse what cannot tell a direction."""
        places = np.asarray(self.elements_m, np.float64)
        if places.ndim != 2 or places.shape[1:] != (3,) or len(places) < 3:
            raise ConfigError("an array needs three antennas or more, each forward, right, down")
        if not np.isfinite(places).all():
            raise ConfigError("places of antennas must be finite numbers")
        if self._rank < 2:
            raise ConfigError(
                "the antennas stand in one line, which cannot tell a direction; move one aside"
            )

    @cached_property
    def baselines_m(self) -> NDArray[np.float64]:
        """From the reference to each of the others, (A - 1, 3)."""
        places = np.asarray(self.elements_m, np.float64)
        return np.asarray(places[1:] - places[0])

    @cached_property
    def axes(self) -> NDArray[np.float64]:
        """Orthonormal rows (D, 3) that span the array in body axes; D is 2 in a plane, else 3."""
        if self._rank == 3:
            return np.eye(3)
        _, _, rows = np.linalg.svd(self.baselines_m)
        return np.asarray(rows[:2])

    @cached_property
    def up(self) -> NDArray[np.float64] | None:
        """Unit normal of a plane array, on the side of the sky; None for one that fills space."""
        if self._rank == 3:
            return None
        normal = np.cross(*self.axes)
        return np.asarray(-normal if normal[2] > 0 else normal)

    def read(self, wavelength_m: float) -> NDArray[np.float64]:
        """Matrix (D, A - 1) from phase differences in cycles to the direction along :attr:`axes`.

        Least squares with the weights of differences that share the reference's noise. Phases grow
        with range, so an antenna that is nearer to the source has the smaller one.
        """
        design = -self.baselines_m @ self.axes.T / wavelength_m
        weights = np.linalg.inv(shared_noise(len(design)))
        return np.asarray(np.linalg.solve(design.T @ weights @ design, design.T @ weights))

    def covariance(self, sigma_cycles: float, wavelength_m: float) -> NDArray[np.float64]:
        """Covariance (D, D) of a direction along :attr:`axes` from one antenna's phase noise.

        For an equilateral triangle 2 sigma^2 / b^2 in both (paper, equation 3 and after).
        """
        read = self.read(wavelength_m)
        return np.asarray(sigma_cycles**2 * read @ shared_noise(read.shape[1]) @ read.T)

    @cached_property
    def _rank(self) -> int:
        sizes = np.linalg.svd(self.baselines_m, compute_uv=False)
        return int(np.sum(sizes > _FLAT * max(float(sizes[0]), 1e-9)))


def shared_noise(differences: int) -> NDArray[np.float64]:
    """Covariance of differences to one antenna, in units of one antenna's variance."""
    return np.eye(differences) + 1.0


def triangle(side_m: float) -> AntennaArray:
    """The published array: equilateral, level, its first side forward."""
    return AntennaArray(
        ((0.0, 0.0, 0.0), (side_m, 0.0, 0.0), (side_m / 2, side_m * math.sqrt(0.75), 0.0))
    )


def array_of(elements_m: Sequence[Sequence[float]]) -> AntennaArray:
    """An array from any sequence of places.

    Raises:
        ConfigError: fewer than three, in one line, or no numbers.
    """
    try:
        places = tuple((float(x), float(y), float(z)) for x, y, z in elements_m)
    except (TypeError, ValueError) as error:
        raise ConfigError("each antenna needs three numbers: forward, right, down") from error
    return AntennaArray(places)
