"""Almanacs from ephemerides and back: the same quantities for GPS and BDS.

Sources: IS-GPS-200, 20.3.3.5.1.2 and table 20-VI; BDS-SIS-ICD-B1I-3.0, table 5-15.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .beidou_satellites import GEO
from .bits import SEMICIRCLE, wrapped
from .ephemeris import Ephemeris
from .time import WEEK_S, GnssTime

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

EARTH_TURN_RAD_S = {"G": 7.2921151467e-5, "C": 7.2921150e-5}
GRAVITY_M3_S2 = {"G": 3.986005e14, "C": 3.986004418e14}
"""WGS-84 as IS-GPS-200 has it; CGCS2000."""
TOA_STEP_S = 4096
ECCENTRICITY, INCLINATION, RATE = 2.0**-21, SEMICIRCLE * 2.0**-19, SEMICIRCLE * 2.0**-38
ANGLE, ROOT, A0, A1 = SEMICIRCLE * 2.0**-23, 2.0**-11, 2.0**-20, 2.0**-38
"""Scales; both systems have the same."""


def reference(time: GnssTime, system: str) -> GnssTime:
    """Almanac's time of reference about that time, within its week."""
    week, tow = time.week_tow(system)
    steps = min(round(tow / TOA_STEP_S), (WEEK_S - 1) // TOA_STEP_S)
    return GnssTime.of_week(week, steps * TOA_STEP_S, system)


def nearest_of(
    ephemerides: Iterable[Ephemeris], system: str, time: GnssTime
) -> dict[int, Ephemeris]:
    """Of each satellite of a system the ephemeris closest to a time."""
    best: dict[int, Ephemeris] = {}
    for e in ephemerides:
        if e.system == system and (
            e.prn not in best or abs(e.toe - time) < abs(best[e.prn].toe - time)
        ):
            best[e.prn] = e
    return best


def inclination(system: str, prn: int) -> float:
    """What ``delta_i`` is counted from, rad."""
    return 0.0 if system == "C" and prn in GEO else 0.3 * SEMICIRCLE


def values(e: Ephemeris, toa: GnssTime) -> dict[str, float]:
    """Fields of an almanac page, by the names used in the layouts."""
    later = toa - e.toe
    motion = math.sqrt(GRAVITY_M3_S2[e.system] / e.a**3) + e.delta_n
    turn = EARTH_TURN_RAD_S[e.system]
    node = e.omega0 + (e.omega_dot - turn) * later
    node += turn * (toa.week_tow(e.system)[1] - e.toe.week_tow(e.system)[1])
    since = toa - e.toc
    return {
        "sqrt_a": math.sqrt(e.a),
        "e": e.e,
        "a0": e.a0 + e.a1 * since + e.a2 * since**2,
        "a1": e.a1,
        "omega0": wrapped(node, ANGLE),
        "omega": wrapped(e.omega, ANGLE),
        "m0": wrapped(e.m0 + motion * later, ANGLE),
        "delta_i": e.i0 + e.i_dot * later - inclination(e.system, e.prn),
        "omega_dot": e.omega_dot,
        "toa": toa.week_tow(e.system)[1],
    }


def ephemeris(
    system: str,
    prn: int,
    message: str,
    page: Mapping[str, float],
    toa: GnssTime,
    transmitted: GnssTime,
    health: int,
) -> Ephemeris:
    """Coarse ephemeris that an almanac page is."""
    return Ephemeris(
        system=system, prn=prn, message=message, toe=toa, toc=toa, transmitted=transmitted,
        a0=page["a0"], a1=page["a1"], a2=0.0, a=page["sqrt_a"] ** 2, a_dot=0.0, e=page["e"],
        m0=page["m0"], delta_n=0.0, delta_n_dot=0.0, omega0=page["omega0"],
        i0=inclination(system, prn) + page["delta_i"], omega=page["omega"],
        omega_dot=page["omega_dot"], i_dot=0.0, cuc=0.0, cus=0.0, crc=0.0, crs=0.0, cic=0.0,
        cis=0.0, iode=0, iodc=0, health=health, accuracy_m=math.nan, fit_interval_s=3.5 * 86400.0,
    )  # fmt: skip
