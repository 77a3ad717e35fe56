"""Pages of subframes 4 and 5 of LNAV: almanac, health, ionosphere and UTC.

Source: IS-GPS-200, 20.3.3.5 and figure 20-1, table 20-V (which page holds what).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import almanac
from .bits import Field, Layout, layout
from .broadcast import Contents, Klobuchar, UtcParameters
from .ephemeris import LNAV
from .time import GnssTime
from .weeks import full_week, nearest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .broadcast import Broadcast

DATA_ID, PAGE_ID = Field("data ID", ((61, 2),)), Field("SV ID", ((63, 6),))
SENT_DATA_ID = 1
PAGES = 25
ALMANAC = layout(
    ("e", "69-84", almanac.ECCENTRICITY),
    ("toa", "91-98", almanac.TOA_STEP_S),
    ("delta_i", "99-114", almanac.INCLINATION),
    ("omega_dot", "121-136", almanac.RATE),
    ("health", "137-144"),
    ("sqrt_a", "151-174", almanac.ROOT),
    ("omega0", "181-204", almanac.ANGLE),
    ("omega", "211-234", almanac.ANGLE),
    ("m0", "241-264", almanac.ANGLE),
    ("a0", "271-278 290-292", almanac.A0),
    ("a1", "279-289", almanac.A1),
    signed="delta_i omega_dot omega0 omega m0 a0 a1",
)
IONOSPHERE = layout(
    ("alpha0", "69-76", 2.0**-30),
    ("alpha1", "77-84", 2.0**-27),
    ("alpha2", "91-98", 2.0**-24),
    ("alpha3", "99-106", 2.0**-24),
    ("beta0", "107-114", 2.0**11),
    ("beta1", "121-128", 2.0**14),
    ("beta2", "129-136", 2.0**16),
    ("beta3", "137-144", 2.0**16),
    signed="alpha0 alpha1 alpha2 alpha3 beta0 beta1 beta2 beta3",
)
UTC = layout(
    ("a1", "151-174", 2.0**-50),
    ("a0", "181-204 211-218", 2.0**-30),
    ("tot", "219-226", 4096),
    ("week", "227-234"),
    ("leap_s", "241-248"),
    ("leap_week", "249-256"),
    ("leap_day", "257-264"),
    ("leap_future_s", "271-278"),
    signed="a0 a1 leap_s leap_future_s",
)
TOA, WEEK_ALMANAC = Field("toa", ((69, 8),), almanac.TOA_STEP_S), Field("WNa", ((77, 8),))
SHORT_WEEK = 256
HEALTH_BITS, NOT_THERE = 6, 63


@dataclass(frozen=True)
class Slot:
    """What a page holds."""

    kind: str
    """'almanac', 'utc' (and ionosphere), 'health' or ''."""
    ident: int
    """SV (page) ID."""


ALMANACS_4 = {2: 25, 3: 26, 4: 27, 5: 28, 7: 29, 8: 30, 9: 31, 10: 32}
OTHERS_4 = {12: 62, 13: 52, 14: 53, 15: 54, 17: 55, 19: 58, 20: 59, 22: 60, 23: 61, 24: 62}
UTC_ID, HEALTH_4_ID, HEALTH_5_ID, RESERVED_ID = 56, 63, 51, 57


def slot(number: int, page: int) -> Slot:
    """What a page of subframe 4 or 5 holds."""
    if number == 5:
        return Slot("almanac", page) if page < PAGES else Slot("health", HEALTH_5_ID)
    if page in ALMANACS_4:
        return Slot("almanac", ALMANACS_4[page])
    if page == 18:
        return Slot("utc", UTC_ID)
    if page == PAGES:
        return Slot("health", HEALTH_4_ID)
    return Slot("", OTHERS_4.get(page, RESERVED_ID))


def kind_of(ident: int) -> str:
    """What a page with that ID holds."""
    named = {UTC_ID: "utc", HEALTH_4_ID: "health", HEALTH_5_ID: "health"}
    return "almanac" if 1 <= ident <= 32 else named.get(ident, "")


def health_layout(ident: int) -> Layout:
    """Health of 6 bits: of satellites 1 to 24 on page 51, of 25 to 32 on page 63."""
    first, bits = (1, range(91, 265)) if ident == HEALTH_5_ID else (25, range(229, 289))
    free = [b for b in bits if (b - 1) % 30 < 24]
    count = len(free) // HEALTH_BITS
    places = [tuple((b, 1) for b in free[6 * n : 6 * n + 6]) for n in range(min(count, 33 - first))]
    return Layout(tuple(Field(str(first + n), at) for n, at in enumerate(places)))


def fill(bits: NDArray[np.uint8], place: Slot, content: Broadcast, now: GnssTime) -> None:
    """Write a page."""
    DATA_ID.write(bits, SENT_DATA_ID)
    known = almanac.nearest_of(content.ephemerides, "G", now)
    PAGE_ID.write(bits, place.ident)
    if place.kind == "almanac":
        if place.ident in known:
            e = known[place.ident]
            values = almanac.values(e, almanac.reference(now, "G"))
            ALMANAC.write(bits, values | {"health": e.health % 256})
        elif known:
            PAGE_ID.write(bits, 0)
    elif place.kind == "health":
        health = {f"G{prn:02d}": e.health for prn, e in known.items()} | dict(content.health)
        fields = health_layout(place.ident)
        absent = NOT_THERE if known else 0
        fields.write(
            bits, {f.name: health.get(f"G{int(f.name):02d}", absent) % 64 for f in fields.fields}
        )
        if place.ident == HEALTH_5_ID:
            toa = almanac.reference(now, "G")
            TOA.write(bits, toa.week_tow("G")[1])
            WEEK_ALMANAC.write(bits, toa.week_tow("G")[0] % SHORT_WEEK)
    elif place.kind == "utc":
        _fill_utc(bits, content, now)


def _fill_utc(bits: NDArray[np.uint8], content: Broadcast, now: GnssTime) -> None:
    if content.klobuchar is not None:
        IONOSPHERE.write(bits, content.klobuchar.fields())
    if content.utc is not None:
        utc = content.utc
        reference = almanac.reference(now, "G")
        UTC.write(
            bits,
            {
                "a0": utc.a0 + utc.a1 * (reference - utc.reference),
                "a1": utc.a1,
                "tot": reference.week_tow("G")[1],
                "week": reference.week_tow("G")[0] % SHORT_WEEK,
                "leap_s": utc.leap_s,
                "leap_week": utc.leap_week % SHORT_WEEK,
                "leap_day": utc.leap_day,
                "leap_future_s": utc.leap_future_s,
            },
        )


def read(bits: NDArray[np.uint8], now: GnssTime) -> Contents:
    """What a page says; ``now`` is when it was sent."""
    ident = PAGE_ID.raw(bits)
    kind = kind_of(ident)
    if kind == "almanac":
        values = ALMANAC.read(bits)
        if values["sqrt_a"] == 0.0:
            return Contents()
        toa = nearest("G", values["toa"], now)
        health = int(values["health"])
        coarse = almanac.ephemeris("G", ident, LNAV, values, toa, now, health)
        return Contents(almanacs=(coarse,))
    if kind == "health":
        values = health_layout(ident).read(bits)
        return Contents(health=tuple((f"G{int(prn):02d}", int(v)) for prn, v in values.items()))
    return _read_utc(bits, now) if kind == "utc" else Contents()


def _read_utc(bits: NDArray[np.uint8], now: GnssTime) -> Contents:
    model = Klobuchar.of(IONOSPHERE.read(bits).values(), "G", now)
    values = UTC.read(bits)
    if not bits[150:].any():
        return Contents(ionosphere=(model,))
    week = full_week("G", int(values["week"]), now, SHORT_WEEK)
    utc = UtcParameters(
        system="G",
        a0=values["a0"],
        a1=values["a1"],
        reference=GnssTime.of_week(week, values["tot"], "G"),
        leap_s=int(values["leap_s"]),
        leap_week=full_week("G", int(values["leap_week"]), now, SHORT_WEEK),
        leap_day=int(values["leap_day"]),
        leap_future_s=int(values["leap_future_s"]),
        transmitted=now,
    )
    return Contents(ionosphere=(model,), utc=(utc,))
