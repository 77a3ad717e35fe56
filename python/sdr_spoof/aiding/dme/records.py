"""What a DME interrogator says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime

    from .stations import Station


@dataclass(frozen=True)
class DmeLog:
    """K slant ranges to D stations, by time."""

    reference: GnssTime | None
    """Instant that ``time_s`` counts from; None where it is not known."""
    stations: tuple[Station, ...]
    time_s: NDArray[np.float64]
    """Ascending, (K,)."""
    station: NDArray[np.int64]
    """Which of the stations, (K,)."""
    range_m: NDArray[np.float64]
    """(K,)"""
