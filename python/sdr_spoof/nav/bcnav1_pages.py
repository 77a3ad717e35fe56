"""Pages of B-CNAV1's subframe 3: health, ionosphere, UTC, offsets of other systems, almanacs.

Sources: BDS-SIS-ICD-B1C-1.0, 6.2.3.3 and chapter 7. The order of pages is free; here every second
one is page 1.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from . import almanac
from . import bcnav1_fields as fields
from .bcnav1_orbit import REFERENCE_A_M, sat_type
from .bits import wrapped
from .broadcast import Bdgim, Contents, TimeOffset, UtcParameters
from .ephemeris import CNAV1
from .time import WEEK_S, GnssTime
from .weeks import full_week

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from .broadcast import Broadcast
    from .ephemeris import Ephemeris

    Bits = NDArray[np.uint8]

CORRECTIONS, REDUCED, OFFSETS, MIDI = 1, 2, 3, 4
"""Page types."""
CYCLE = (CORRECTIONS, MIDI, CORRECTIONS, REDUCED, CORRECTIONS, OFFSETS)
SYSTEMS = {1: "G", 2: "E", 3: "R"}
"""Whose time a BGTO is about."""
CLOCK_UNUSABLE = 0x80
"""Health in almanacs: the clock, and with it everything."""


def fill(bits: Bits, content: Broadcast, index: int, now: GnssTime) -> None:
    """Write the page of a frame; ``index`` counts frames from the start of the week."""
    page, turn = CYCLE[index % len(CYCLE)], index // len(CYCLE)
    known = sorted(almanac.nearest_of(content.ephemerides, "C", now).items())
    if (page in (MIDI, REDUCED) and not known) or (page == OFFSETS and not content.offsets):
        page = CORRECTIONS
    bad = content.ephemeris.health != 0
    values = {"page": page, "health": bad, "dif": 0, "sif": 0, "aif": 0, "sismai": 0}
    fields.HEADER.write(bits, values)
    satellites = [e for _, e in known]
    if page == CORRECTIONS:
        _fill_corrections(bits, content)
    elif page == OFFSETS:
        _fill_offset(bits, content.offsets[turn % len(content.offsets)])
    elif page == MIDI:
        _fill_midi(bits, satellites[turn % len(satellites)], content, now)
    else:
        start = turn * fields.REDUCED_COUNT
        chosen = [satellites[(start + n) % len(satellites)] for n in range(fields.REDUCED_COUNT)]
        _fill_reduced(bits, chosen[: len(satellites)], content, now)


def _fill_corrections(bits: Bits, content: Broadcast) -> None:
    if content.bdgim is not None:
        names = [f.name for f in fields.BDGIM.fields]
        fields.BDGIM.write(bits, dict(zip(names, content.bdgim.alpha, strict=True)))
    utc = content.utc
    if utc is not None:
        reference, a0, a1 = _on_step(utc.reference, utc.a0, utc.a1, utc.a2)
        week, tow = reference.week_tow("C")
        fields.UTC.write(
            bits,
            {
                "a0": a0,
                "a1": a1,
                "a2": utc.a2,
                "leap_s": utc.leap_s,
                "tow": tow,
                "week": week % 8192,
                "leap_week": utc.leap_week % 8192,
                "leap_day": utc.leap_day,
                "leap_future_s": utc.leap_future_s,
            },
        )


def _fill_offset(bits: Bits, offset: TimeOffset) -> None:
    reference, a0, a1 = _on_step(offset.reference, offset.a0, offset.a1, offset.a2)
    week, tow = reference.week_tow("C")
    system = next(n for n, s in SYSTEMS.items() if s == offset.other)
    values = {"system": system, "week": week % 8192, "tow": tow}
    fields.BGTO.write(bits, values | {"a0": a0, "a1": a1, "a2": offset.a2})


def _on_step(reference: GnssTime, a0: float, a1: float, a2: float) -> tuple[GnssTime, float, float]:
    """A polynomial about the time before it that the message can tell."""
    week, tow = reference.week_tow("C")
    step = tow // fields.OFFSET_STEP_S * fields.OFFSET_STEP_S
    back = tow - step
    return (
        GnssTime.of_week(week, step, "C"),
        a0 - a1 * back + a2 * back**2,
        a1 - 2 * a2 * back,
    )


def _fill_midi(bits: Bits, e: Ephemeris, content: Broadcast, now: GnssTime) -> None:
    toa = almanac.reference(now, "C")
    values = almanac.values(e, toa)
    for name in ("omega0", "omega", "m0"):
        values[name] = wrapped(values[name], fields.MIDI_ANGLE)
    more = {"prn": e.prn, "sat_type": sat_type(e.prn, e.a), "week": toa.week_tow("C")[0] % 8192}
    fields.MIDI.write(bits, values | more | {"health": _health(e, content)})


def _fill_reduced(
    bits: Bits, satellites: list[Ephemeris], content: Broadcast, now: GnssTime
) -> None:
    toa = almanac.reference(now, "C")
    fields.ALMANAC_WEEK.write(bits, {"week": toa.week_tow("C")[0] % 8192, "toa": _tow(toa)})
    for e, layout in zip(satellites, fields.REDUCED, strict=False):
        values, kind = almanac.values(e, toa), sat_type(e.prn, e.a)
        layout.write(
            bits,
            {
                "prn": e.prn,
                "sat_type": kind,
                "delta_a": e.a - REFERENCE_A_M[kind],
                "omega0": wrapped(values["omega0"], fields.REDUCED_ANGLE),
                "phi0": wrapped(values["m0"] + values["omega"], fields.REDUCED_ANGLE),
                "health": _health(e, content),
            },
        )


def _tow(time: GnssTime) -> float:
    return time.week_tow("C")[1]


def _health(e: Ephemeris, content: Broadcast) -> int:
    told = dict(content.health).get(f"C{e.prn:02d}", e.health)
    return CLOCK_UNUSABLE if told else 0


def read(bits: Bits, now: GnssTime) -> Contents:
    """What a page of 240 bits says, its header left out; ``now`` is when it was sent."""
    page = int(fields.HEADER.read(bits)["page"])
    if page == CORRECTIONS:
        return _read_corrections(bits, now)
    if page == OFFSETS:
        return _read_offset(bits, now)
    if page == MIDI:
        return _read_midi(bits, now)
    if page == REDUCED:
        return _read_reduced(bits, now)
    return Contents()


def health(bits: Bits) -> int:
    """Health of the sender, 0 where it may be used: its status, and its integrity flags.

    A message whose errors exceed what was predicted (DIF), or a signal that is not normal (SIF),
    counts as status 1.
    """
    header = fields.HEADER.read(bits)
    return int(header["health"]) or int(header["dif"] or header["sif"])


def _read_corrections(bits: Bits, now: GnssTime) -> Contents:
    found = Contents()
    a1, a2, a3, a4, a5, a6, a7, a8, a9 = fields.BDGIM.read(bits).values()
    if a1:
        found += Contents(ionosphere=(Bdgim((a1, a2, a3, a4, a5, a6, a7, a8, a9), "C", now),))
    values = fields.UTC.read(bits)
    if any(values.values()):
        utc = UtcParameters(
            system="C",
            a0=values["a0"],
            a1=values["a1"],
            a2=values["a2"],
            reference=_instant(values, "tow", now),
            leap_s=int(values["leap_s"]),
            leap_week=full_week("C", int(values["leap_week"]), now),
            leap_day=int(values["leap_day"]),
            leap_future_s=int(values["leap_future_s"]),
            transmitted=now,
        )
        found += Contents(utc=(utc,))
    return found


def _instant(values: Mapping[str, float], tow: str, now: GnssTime) -> GnssTime:
    week = full_week("C", int(values["week"]), now)
    return GnssTime.of_week(week, min(values[tow], WEEK_S - 1), "C")


def _read_offset(bits: Bits, now: GnssTime) -> Contents:
    values = fields.BGTO.read(bits)
    other = SYSTEMS.get(int(values["system"]))
    if other is None:
        return Contents()
    reference = _instant(values, "tow", now)
    a0, a1, a2 = values["a0"], values["a1"], values["a2"]
    return Contents(offsets=(TimeOffset("C", other, a0, a1, reference, a2, now),))


def _read_midi(bits: Bits, now: GnssTime) -> Contents:
    values = fields.MIDI.read(bits)
    prn, told = int(values["prn"]), int(values["health"])
    if not prn or not values["sqrt_a"]:
        return Contents()
    toa = _instant(values, "toa", now)
    coarse = almanac.ephemeris("C", prn, CNAV1, values, toa, now, told)
    return Contents(almanacs=(coarse,), health=((f"C{prn:02d}", told),))


def _read_reduced(bits: Bits, now: GnssTime) -> Contents:
    """Reduced almanacs: circles, whose mean anomaly counts from the node."""
    toa = _instant(fields.ALMANAC_WEEK.read(bits), "toa", now)
    found = Contents()
    for layout in fields.REDUCED:
        values = layout.read(bits)
        prn, told, kind = (int(values[name]) for name in ("prn", "health", "sat_type"))
        if not prn or kind not in REFERENCE_A_M:
            continue
        page = dict.fromkeys(("a0", "a1", "e", "omega", "omega_dot", "delta_i"), 0.0)
        page |= {"omega0": values["omega0"], "m0": values["phi0"]}
        page["sqrt_a"] = math.sqrt(REFERENCE_A_M[kind] + values["delta_a"])
        coarse = almanac.ephemeris("C", prn, CNAV1, page, toa, now, told)
        found += Contents(almanacs=(coarse,), health=((f"C{prn:02d}", told),))
    return found
