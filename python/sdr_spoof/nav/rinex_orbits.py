"""Ephemerides as RINEX navigation files have them: which quantity stands where.

Sources: RINEX 3.05, tables A5 (GPS) and A14 (BDS); RINEX 4.00, tables A6 (LNAV), A17 (D1, D2) and
A18 (CNV1).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .ephemeris import CNAV1, D1, D2, LNAV, Ephemeris
from .plausible import objection
from .rinex_lines import MalformedError
from .time import WEEK_S, GnssTime
from .weeks import nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

_ORBIT = (
    ("cuc", "e", "cus", "sqrt_a"),
    ("toe", "cic", "omega0", "cis"),
    ("i0", "crc", "omega", "omega_dot"),
)
_LEGACY = (
    ("iode", "crs", "delta_n", "m0"),
    *_ORBIT,
    ("i_dot", "codes", "week", "l2p"),
)
LINES: dict[str, tuple[tuple[str, str, str, str], ...]] = {
    LNAV: (
        *_LEGACY,
        ("accuracy_m", "health", "tgd", "iodc"),
        ("transmitted", "fit", "", ""),
    ),
    D1: (
        *_LEGACY,
        ("accuracy_m", "health", "tgd1", "tgd2"),
        ("transmitted", "iodc", "", ""),
    ),
    CNAV1: (
        ("a_dot", "crs", "delta_n", "m0"),
        *_ORBIT,
        ("i_dot", "delta_n_dot", "type", "top"),
        ("sisai_oe", "sisai_ocb", "sisai_oc1", "sisai_oc2"),
        ("isc_b1cd", "", "tgd_b1cp", "tgd_b2ap"),
        ("sismai", "health", "integrity", "iodc"),
        ("transmitted", "", "", "iode"),
    ),
}
"""Names of the quantities, line by line after the clock's."""
LINES[D2] = LINES[D1]
SYSTEMS = {LNAV: "G", D1: "C", D2: "C", CNAV1: "C"}
SAME = (
    "a0", "a1", "a2", "e", "m0", "delta_n", "omega0", "i0", "omega", "omega_dot", "i_dot",
    "cuc", "cus", "crc", "crs", "cic", "cis",
)  # fmt: skip
UNKNOWN_TOW_S = 2 * WEEK_S
NORMAL_FIT_H, LONG_FIT_H = 4.0, 6.0


def ephemeris(message: str, prn: int, toc: GnssTime, fields: Mapping[str, float]) -> Ephemeris:
    """Ephemeris of a record.

    Raises:
        MalformedError: if a quantity is out of range.
    """
    system = SYSTEMS[message]
    if not 0.0 <= fields["toe"] < WEEK_S:
        raise MalformedError(f"toe is {fields['toe']:g}, must be within the week")
    sent = fields["transmitted"]
    known = abs(sent) < UNKNOWN_TOW_S
    same: dict[str, Any] = {name: fields[name] for name in SAME}
    found = Ephemeris(
        system=system,
        prn=prn,
        message=message,
        toe=nearest(system, fields["toe"], toc),
        toc=toc,
        transmitted=nearest(system, sent % WEEK_S, toc) if known else toc,
        a=fields["sqrt_a"] ** 2,
        a_dot=fields.get("a_dot", 0.0),
        delta_n_dot=fields.get("delta_n_dot", 0.0),
        iode=round(fields["iode"]),
        iodc=round(fields["iodc"]),
        health=round(fields["health"]),
        accuracy_m=fields.get("accuracy_m", math.nan),
        group_delays_s=_delays(message, fields),
        fit_interval_s=_fit_s(fields.get("fit", 0.0)),
        **same,
    )
    why = objection(found)
    if why is not None:
        raise MalformedError(why)
    return found


def _fit_s(hours: float) -> float:
    """Half of the fit interval; some files have the message's flag in place of hours."""
    if hours == 1.0:
        hours = LONG_FIT_H
    return 1800.0 * (hours if 2.0 <= hours <= 200.0 else NORMAL_FIT_H)


def _delays(message: str, fields: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    if message == LNAV:
        return (("L1CA", fields["tgd"]),)
    if message == CNAV1:
        pilot = fields["tgd_b1cp"]
        return (("B1CP", pilot), ("B1CD", pilot + fields["isc_b1cd"]))
    return (("B1I", fields["tgd1"]), ("B2I", fields["tgd2"]))


def fields(e: Ephemeris) -> dict[str, float]:
    """Quantities of a record; what is not known is 0."""
    found = {name: float(getattr(e, name)) for name in SAME}
    pilot = e.group_delay_s("B1CP")
    return found | {
        "a_dot": e.a_dot,
        "delta_n_dot": e.delta_n_dot,
        "sqrt_a": math.sqrt(e.a),
        "toe": e.toe.week_tow(e.system)[1],
        "week": e.toe.week_tow(e.system)[0],
        "transmitted": e.transmitted - GnssTime.of_week(e.toe.week_tow(e.system)[0], 0, e.system),
        "iode": e.iode,
        "iodc": e.iodc,
        "health": e.health,
        "accuracy_m": e.accuracy_m,
        "fit": e.fit_interval_s / 1800.0,
        "tgd": e.group_delay_s("L1CA"),
        "tgd1": e.group_delay_s("B1I"),
        "tgd2": e.group_delay_s("B2I"),
        "tgd_b1cp": pilot,
        "isc_b1cd": e.group_delay_s("B1CD") - pilot if e.message == CNAV1 else 0.0,
        "type": 3.0,
    }
