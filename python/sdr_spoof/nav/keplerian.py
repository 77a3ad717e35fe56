"""The quantities of a broadcast orbit and clock as the fields of LNAV, D1 and D2 have them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from . import accuracy
from .bits import SEMICIRCLE, wrapped
from .ephemeris import Ephemeris
from .weeks import nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .time import GnssTime

SAME = (
    "a0", "a1", "a2", "e", "m0", "delta_n", "omega0", "i0", "omega", "omega_dot", "i_dot",
    "cuc", "cus", "crc", "crs", "cic", "cis",
)  # fmt: skip
"""Quantities whose field has their name and unit."""
RATE, ANGLE = SEMICIRCLE * 2.0**-43, SEMICIRCLE * 2.0**-31
ANGLES = ("m0", "omega0", "omega")


def values(e: Ephemeris) -> dict[str, float]:
    """Fields of an ephemeris."""
    found = {name: getattr(e, name) for name in SAME}
    found.update({name: wrapped(found[name], ANGLE) for name in ANGLES})
    return found | {
        "sqrt_a": math.sqrt(e.a),
        "toe": e.toe.week_tow(e.system)[1],
        "toc": e.toc.week_tow(e.system)[1],
        "health": e.health,
        "accuracy": accuracy.index(e.accuracy_m),
        "iode": e.iode,
        "iodc": e.iodc,
    }


def ephemeris(
    system: str,
    prn: int,
    message: str,
    fields: Mapping[str, float],
    transmitted: GnssTime,
    group_delays_s: tuple[tuple[str, float], ...],
    fit_interval_s: float = 7200.0,
) -> Ephemeris:
    """Ephemeris that fields make, its references in the weeks nearest to its transmission."""
    same: dict[str, Any] = {name: fields[name] for name in SAME}
    return Ephemeris(
        system=system,
        prn=prn,
        message=message,
        toe=nearest(system, fields["toe"], transmitted),
        toc=nearest(system, fields["toc"], transmitted),
        transmitted=transmitted,
        a=fields["sqrt_a"] ** 2,
        a_dot=0.0,
        delta_n_dot=0.0,
        iode=int(fields["iode"]),
        iodc=int(fields["iodc"]),
        health=int(fields["health"]),
        accuracy_m=accuracy.metres(int(fields["accuracy"])),
        group_delays_s=group_delays_s,
        fit_interval_s=fit_interval_s,
        **same,
    )
