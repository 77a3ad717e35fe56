"""Ephemeris and clock of B-CNAV1's subframe 2.

Sources: BDS-SIS-ICD-B1C-1.0, 7.4 (issue of data), 7.5 (clock, against B3I as in D1 and D2), 7.6
(group delays), 7.7 (orbit).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..errors import NavigationError
from . import bcnav1_fields as fields
from .beidou_satellites import GEO
from .bits import wrapped
from .ephemeris import CNAV1, Ephemeris
from .keplerian import ANGLES, SAME
from .time import GnssTime
from .weeks import nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

REFERENCE_A_M = {1: 42_162_200.0, 2: 42_162_200.0, 3: 27_906_100.0}
"""Semi-major axis that ``delta_a`` is counted from, by type: geostationary, inclined, medium."""
HIGH_M = 35e6
"""Geosynchronous orbits are above, medium ones below."""
FRESH_ISSUES = 60
"""Issues of data 0 to 59 say that they are no more than 12 hours old."""


def sat_type(prn: int, a: float) -> int:
    """1: geostationary, 2: inclined, 3: medium."""
    return 1 if prn in GEO else 2 if a > HIGH_M else 3


def issues(e: Ephemeris) -> tuple[int, int]:
    """IODE and IODC; from the hour of ``toe`` where the ephemeris is from D1, whose are shorter."""
    if e.message == CNAV1:
        return e.iode, e.iodc
    hour = int(e.toe.week_tow("C")[1]) // 3600 % FRESH_ISSUES
    return hour, hour


def values(e: Ephemeris) -> dict[str, float]:
    """Fields of an ephemeris, all but week and hour.

    Raises:
        NavigationError: if its times are no multiples of 300 s.
    """
    found = {name: getattr(e, name) for name in SAME}
    found.update({name: wrapped(found[name], fields.ORBIT_ANGLE) for name in ANGLES})
    for name, time in (("toe", e.toe), ("toc", e.toc)):
        found[name] = time.week_tow("C")[1]
        if found[name] % fields.TIME_STEP_S:
            raise NavigationError(
                f"C{e.prn:02d}: {name} is {found[name]:g} s of the week; B-CNAV1 can only tell "
                f"multiples of {fields.TIME_STEP_S} s"
            )
    kind = sat_type(e.prn, e.a)
    iode, iodc = issues(e)
    pilot, data = e.group_delay_s("B1CP"), e.group_delay_s("B1CD")
    return found | {
        "iode": iode,
        "iodc": iodc,
        "sat_type": kind,
        "delta_a": e.a - REFERENCE_A_M[kind],
        "a_dot": e.a_dot,
        "delta_n_dot": e.delta_n_dot,
        "tgd_b1cp": pilot,
        "isc_b1cd": data - pilot,
        "tgd_b2ap": e.group_delay_s("B2AP"),
    }


def ephemeris(
    prn: int, found: Mapping[str, float], transmitted: GnssTime, health: int
) -> Ephemeris | None:
    """Ephemeris that fields make; None where orbit and clock are not of one issue, or no orbit."""
    iode, iodc, kind = (int(found[name]) for name in ("iode", "iodc", "sat_type"))
    if kind not in REFERENCE_A_M or iode != iodc % 256:
        return None
    return Ephemeris(
        system="C",
        prn=prn,
        message=CNAV1,
        toe=nearest("C", found["toe"], transmitted),
        toc=nearest("C", found["toc"], transmitted),
        transmitted=transmitted,
        a=REFERENCE_A_M[kind] + found["delta_a"],
        a_dot=found["a_dot"],
        delta_n_dot=found["delta_n_dot"],
        iode=iode,
        iodc=iodc,
        health=health,
        accuracy_m=math.nan,
        group_delays_s=(
            ("B1CP", found["tgd_b1cp"]),
            ("B1CD", found["tgd_b1cp"] + found["isc_b1cd"]),
            ("B2AP", found["tgd_b2ap"]),
        ),
        **{name: found[name] for name in SAME},
    )
