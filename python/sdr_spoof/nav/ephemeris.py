"""One record for the broadcast orbit and clock of a satellite, whichever message it came in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .time import GnssTime

if TYPE_CHECKING:
    from collections.abc import Mapping

LNAV, D1, D2, CNAV1 = "LNAV", "D1", "D2", "CNV1"
"""Messages, by the names of RINEX 4."""
B1C = ("B1CP", "B1CD")


@dataclass(frozen=True)
class Ephemeris:
    """Broadcast orbit and clock: m, s, rad; names as in RINEX.

    Sources: IS-GPS-200 table 20-III (LNAV), BDS-SIS-ICD-B1I-3.0 table 5-10 (D1, D2),
    BDS-SIS-ICD-B1C-1.0 tables 7-4 and 7-7 (B-CNAV1, which has ``a_dot`` and ``delta_n_dot``).
    """

    system: str
    """RINEX system letter."""
    prn: int
    message: str
    toe: GnssTime
    """Reference of the orbit."""
    toc: GnssTime
    """Reference of the clock."""
    transmitted: GnssTime
    """When it was sent."""
    a0: float
    a1: float
    a2: float
    a: float
    """Semi-major axis at ``toe``."""
    a_dot: float
    e: float
    m0: float
    delta_n: float
    delta_n_dot: float
    omega0: float
    i0: float
    omega: float
    omega_dot: float
    i_dot: float
    cuc: float
    cus: float
    crc: float
    crs: float
    cic: float
    cis: float
    iode: int
    """LNAV, B-CNAV1: IODE; D1, D2: AODE."""
    iodc: int
    """LNAV, B-CNAV1: IODC; D1, D2: AODC."""
    health: int
    """0: healthy."""
    accuracy_m: float
    """URA; NaN where the message states none."""
    group_delays_s: tuple[tuple[str, float], ...] = ()
    """Each signal's own delay against the clock: subtract it from the clock's bias. By registry
    signal: (("B1I", TGD1),), (("B1CP", TGD_B1Cp), ("B1CD", TGD_B1Cp + ISC_B1Cd)), (("L1CA", TGD),).
    """
    fit_interval_s: float = 7200.0
    """How long before and after ``toe`` it is meant to be used."""

    def group_delay_s(self, signal: str) -> float:
        """Delay of a registry signal against the broadcast clock; 0 where none is stated.

        D1 states none of B1C: it is taken to be that of B1I, from which it differs by nanoseconds
        where either is tens of them.
        """
        return delay_s(dict(self.group_delays_s), signal) or 0.0


def delay_s(stated: Mapping[str, float], signal: str) -> float | None:
    """Delay of a signal by those that messages state; None where nothing tells it."""
    return stated.get(signal, stated.get("B1I") if signal in B1C else None)
