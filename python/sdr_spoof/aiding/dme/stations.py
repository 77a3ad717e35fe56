"""DME stations and the noise of their slant ranges.

A DME interrogator measures the slant range to a ground station by asking it. Its clock error and
that of the transponder's delay are one unknown, the same for all stations here.

Noise: sigma^2 = (0.05 NM)^2 + max(0.085 NM, 0.125 % of the range)^2, station and interrogator
(ICAO Annex 10, volume I, attachment C; RTCA DO-236C, appendix C).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.geodesy import geodetic_to_ecef

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

NAUTICAL_MILE_M = 1852.0
STATION_NM, LEAST_NM, SHARE = 0.05, 0.085, 0.00125
"""Of the station; of the interrogator, at least, and by the range."""


@dataclass(frozen=True)
class Station:
    """One DME."""

    name: str
    latitude_deg: float
    longitude_deg: float
    height_m: float = 0.0

    @property
    def position_m(self) -> NDArray[np.float64]:
        """Earth-fixed, (3,)."""
        place = (self.latitude_deg, self.longitude_deg, self.height_m)
        return geodetic_to_ecef(np.array(place))


def sigma_m(slant_m: ArrayLike) -> NDArray[np.float64]:
    """Standard deviation of a slant range, of the same shape."""
    slant = np.abs(np.asarray(slant_m, dtype=np.float64))
    interrogator = np.maximum(LEAST_NM * NAUTICAL_MILE_M, SHARE * slant)
    return np.asarray(np.hypot(STATION_NM * NAUTICAL_MILE_M, interrogator))


def slant_ranges_m(
    stations: tuple[Station, ...], position_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distances of D stations from places (..., 3): (..., D)."""
    there = np.stack([s.position_m for s in stations])
    return np.asarray(np.linalg.norm(position_m[..., None, :] - there, axis=-1))
