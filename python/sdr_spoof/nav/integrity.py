"""What geostationary BDS satellites say of others: integrity, corrections, grid of the ionosphere.

Source: BDS-SIS-ICD-B1I-3.0, 5.3.3 (BDID, UDREI, RURAI, equivalent clock correction, grid).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .time import GnssTime

UDRE_M = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 50.0, 100.0, 150.0)
"""Error of the differential correction by UDREI, 99.9 %; 14: not monitored, 15: not available."""
RURA_M = (
    0.75, 1.0, 1.25, 1.75, 2.25, 3.0, 3.75, 4.5, 5.25, 6.0, 7.5, 15.0, 50.0, 150.0, 300.0,
)  # fmt: skip
"""Error of the pseudorange without correction by RURAI, 99.9 %; 15: more than 300 m."""
GIVE_M = (
    0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1, 2.4, 2.7, 3.0, 3.6, 4.5, 6.0, 9.0, 15.0, 45.0,
)  # fmt: skip
"""Error of a vertical delay by GIVEI, 99.9 %."""
NOT_MONITORED, NOT_AVAILABLE = 14, 15
WORSE = 15
"""RURAI of a satellite whose pseudoranges are more than 300 m off."""
IGPS = 320


@dataclass(frozen=True)
class Integrity:
    """One satellite, as a geostationary one judges it for its region."""

    prn: int
    udrei: int
    rurai: int
    correction_m: float = math.nan
    """Equivalent clock correction, to be added to the pseudorange of B1I; NaN where there is none.
    """
    transmitted: GnssTime | None = None
    system: str = "C"

    @property
    def udre_m(self) -> float:
        """Error of the differential correction, 99.9 %; NaN for none."""
        return UDRE_M[self.udrei] if self.udrei < NOT_MONITORED else math.nan

    @property
    def rura_m(self) -> float:
        """Error of the pseudorange without correction, 99.9 %; infinite beyond 300 m."""
        return RURA_M[self.rurai] if self.rurai < WORSE else math.inf

    @property
    def usable(self) -> bool:
        """False where the correction is not available, or the range error beyond 300 m.

        A satellite that is not monitored is not accused.
        """
        return self.udrei != NOT_AVAILABLE and self.rurai != WORSE


@dataclass(frozen=True)
class GridPoint:
    """Vertical delay of the ionosphere for B1I over one place."""

    igp: int
    """Number of the point, 1 to 320."""
    delay_m: float
    """NaN where the point is not monitored."""
    givei: int
    transmitted: GnssTime | None = None

    @property
    def give_m(self) -> float:
        """Error of the delay, 99.9 %."""
        return GIVE_M[self.givei]

    @property
    def place_deg(self) -> tuple[float, float]:
        """Latitude and longitude."""
        return place_deg(self.igp)


def place_deg(igp: int) -> tuple[float, float]:
    """Latitude and longitude of a grid point.

    Two grids of 5 degrees, 70 to 145 degrees east: 10 to 55 degrees north, and 2.5 less.
    """
    shifted, n = divmod(igp - 1, IGPS // 2)
    column, row = divmod(n, 10)
    return 10.0 + 5.0 * row - 2.5 * shifted, 70.0 + 5.0 * column
