"""Pages that D1 and D2 share: almanac, health, time offsets, UTC.

Source: BDS-SIS-ICD-B1I-3.0, figures 5-10 to 5-12 and 5-15 to 5-18 (D1), 5.3.2 (D2, the same
places).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import almanac, bch15
from .bits import Field, Layout, layout
from .broadcast import Contents, TimeOffset, UtcParameters
from .time import GnssTime
from .weeks import full_week, nearest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .broadcast import Broadcast

PAGE = Field("Pnum", ((44, 7),))
ALMANAC = layout(
    ("sqrt_a", "51-52 61-82", almanac.ROOT),
    ("a1", "91-101", almanac.A1),
    ("a0", "102-112", almanac.A0),
    ("omega0", "121-142 151-152", almanac.ANGLE),
    ("e", "153-169", almanac.ECCENTRICITY),
    ("delta_i", "170-172 181-193", almanac.INCLINATION),
    ("toa", "194-201", almanac.TOA_STEP_S),
    ("omega_dot", "202 211-226", almanac.RATE),
    ("omega", "227-232 241-258", almanac.ANGLE),
    ("m0", "259-262 271-290", almanac.ANGLE),
    signed="a1 a0 omega0 delta_i omega_dot omega m0",
)
GROUP = Field("AmEpID", ((291, 2),))
"""3 in the almanacs of satellites 1 to 30: those of 31 to 63 are sent as well. In these, AmID: 1, 2
and 3 for satellites from 31, 44 and 57 on."""
HEALTH_GROUP = Field("AmID", ((216, 2),))
WEEK_ALMANAC = Field("WNa", ((190, 8),))
TOA = Field("toa", ((198, 5), (211, 3)), almanac.TOA_STEP_S)
OFFSETS = layout(
    ("a0_G", "97-110", 1e-10),
    ("a1_G", "111-112 121-134", 1e-10),
    ("a0_E", "135-142 151-156", 1e-10),
    ("a1_E", "157-172", 1e-10),
    ("a0_R", "181-194", 1e-10),
    ("a1_R", "195-202 211-218", 1e-10),
    signed="a0_G a1_G a0_E a1_E a0_R a1_R",
)
UTC = layout(
    ("leap_s", "51-52 61-66"),
    ("leap_future_s", "67-74"),
    ("leap_week", "75-82"),
    ("a0", "91-112 121-130", 2.0**-30),
    ("a1", "131-142 151-162", 2.0**-50),
    ("leap_day", "163-170"),
    signed="leap_s leap_future_s a0 a1",
)
CLOCK_UNUSABLE, NOT_THERE = 0x100, 0x1FF
"""Health of a satellite (table 5-16): its clock is not usable; it is off for good."""
GROUPS = {1: range(31, 44), 2: range(44, 57), 3: range(57, 64)}
"""Satellites of the expanded almanacs, by AmID."""
EXPANDED = 3
"""AmEpID where the expanded almanacs are sent."""


@dataclass(frozen=True)
class Slot:
    """What a page holds."""

    kind: str
    """'almanac', 'expanded' (almanac), 'health', 'dated health', 'expanded health', 'offsets',
    'utc', 'grid' (of the ionosphere, D2; sent as not monitored) or ''."""
    first: int = 0
    """Satellite, or first one; of an expanded almanac: its place in its group."""
    count: int = 0


def health_layout(first: int, count: int) -> Layout:
    """Health of satellites one after the other, 9 bits each from bit 51 on, parity left out."""
    free = [b for b in range(51, bch15.SUBFRAME) if (b - 1) % 30 < 22]
    places = [tuple((b, 1) for b in free[9 * n : 9 * n + 9]) for n in range(count)]
    return Layout(tuple(Field(str(first + n), at) for n, at in enumerate(places)))


def fill(
    bits: NDArray[np.uint8], slot: Slot, group: int, content: Broadcast, now: GnssTime
) -> None:
    """Write a page; ``group`` is the expanded group that is due."""
    if slot.kind in ("almanac", "expanded"):
        _fill_almanac(bits, slot, group, content, now)
    elif slot.kind.endswith("health"):
        _fill_health(bits, slot, group, content, now)
    elif slot.kind == "offsets":
        values = {f.name: 0.0 for f in OFFSETS.fields}
        for offset in content.offsets:
            values[f"a0_{offset.other}"] = offset.a0 + offset.a1 * (_week(now) - offset.reference)
            values[f"a1_{offset.other}"] = offset.a1
        OFFSETS.write(bits, values)
    elif slot.kind == "grid":
        bits[PAGE.at[0][0] + 6 :] = 1
    elif slot.kind == "utc" and content.utc is not None:
        utc = content.utc
        UTC.write(
            bits,
            {
                "leap_s": utc.leap_s,
                "leap_future_s": utc.leap_future_s,
                "leap_week": utc.leap_week % 256,
                "leap_day": utc.leap_day,
                "a0": utc.a0 + utc.a1 * (_week(now) - utc.reference),
                "a1": utc.a1,
            },
        )


def _week(now: GnssTime) -> GnssTime:
    """Start of the week: what D1 and D2 count offsets from."""
    return GnssTime.of_week(now.week_tow("C")[0], 0.0, "C")


def _fill_almanac(
    bits: NDArray[np.uint8], slot: Slot, group: int, content: Broadcast, now: GnssTime
) -> None:
    prn, mark = slot.first, EXPANDED
    if slot.kind == "expanded":
        if slot.first >= len(GROUPS[group]):
            return
        prn, mark = GROUPS[group][slot.first], group
    known = almanac.nearest_of(content.ephemerides, "C", now)
    if prn in known:
        ALMANAC.write(bits, almanac.values(known[prn], almanac.reference(now, "C")))
    GROUP.write(bits, mark)


def _fill_health(
    bits: NDArray[np.uint8], slot: Slot, group: int, content: Broadcast, now: GnssTime
) -> None:
    first, count = slot.first, slot.count
    if slot.kind == "expanded health":
        first, count = GROUPS[group].start, len(GROUPS[group])
        HEALTH_GROUP.write(bits, group)
    known = almanac.nearest_of(content.ephemerides, "C", now)
    health = {f"C{prn:02d}": CLOCK_UNUSABLE * (e.health != 0) for prn, e in known.items()}
    health.update(content.health)
    absent = NOT_THERE if known else 0
    names = range(first, first + count)
    values = {str(prn): health.get(f"C{prn:02d}", absent) for prn in names}
    health_layout(first, count).write(bits, values)
    if slot.kind == "dated health":
        toa = almanac.reference(now, "C")
        WEEK_ALMANAC.write(bits, toa.week_tow("C")[0] % 256)
        TOA.write(bits, toa.week_tow("C")[1])


def read(bits: NDArray[np.uint8], slot: Slot, message: str, now: GnssTime) -> Contents:
    """What a page says; ``now`` is when it was sent."""
    if slot.kind in ("almanac", "expanded"):
        return _read_almanac(bits, slot, message, now)
    if slot.kind.endswith("health"):
        return _read_health(bits, slot)
    if slot.kind == "offsets":
        values = OFFSETS.read(bits)
        start = _week(now)
        offsets = (
            TimeOffset("C", s, values[f"a0_{s}"], values[f"a1_{s}"], start, transmitted=now)
            for s in "GER"
        )
        return Contents(offsets=tuple(o for o in offsets if o.a0 or o.a1))
    if slot.kind == "utc" and bits[50:].any():
        return Contents(utc=(_read_utc(bits, now),))
    return Contents()


def _read_utc(bits: NDArray[np.uint8], now: GnssTime) -> UtcParameters:
    values = UTC.read(bits)
    return UtcParameters(
        system="C",
        a0=values["a0"],
        a1=values["a1"],
        reference=_week(now),
        leap_s=int(values["leap_s"]),
        leap_week=full_week("C", int(values["leap_week"]), now, 256),
        leap_day=int(values["leap_day"]),
        leap_future_s=int(values["leap_future_s"]),
        transmitted=now,
    )


def _read_almanac(bits: NDArray[np.uint8], slot: Slot, message: str, now: GnssTime) -> Contents:
    values = ALMANAC.read(bits)
    prn = slot.first
    if slot.kind == "expanded":
        group = GROUPS.get(GROUP.raw(bits), range(0))
        prn = group[slot.first] if slot.first < len(group) else 0
    if prn == 0 or values["sqrt_a"] == 0.0:
        return Contents()
    toa = nearest("C", values["toa"], now)
    coarse = almanac.ephemeris("C", prn, message, values, toa, now, health=0)
    return Contents(almanacs=(coarse,))


def _read_health(bits: NDArray[np.uint8], slot: Slot) -> Contents:
    first, count = slot.first, slot.count
    if slot.kind == "expanded health":
        group = GROUPS.get(HEALTH_GROUP.raw(bits), range(0))
        first, count = group.start, len(group)
    values = health_layout(first, count).read(bits)
    return Contents(health=tuple((f"C{int(prn):02d}", int(v)) for prn, v in values.items()))
