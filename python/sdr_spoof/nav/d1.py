"""D1, the message of BDS satellites in medium and inclined orbits on B1I, 50 bps.

Source: BDS-SIS-ICD-B1I-3.0, 5.2: superframes of 24 frames, frames of 5 subframes, 6 s each, from
the start of the week on. Subframes 1 to 3 repeat; 4 and 5 have 24 pages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import beidou_pages, keplerian
from .beidou import SIGNAL, BeidouMessage, gather, ionosphere, legacy_ephemeris, together
from .beidou_pages import PAGE, Slot
from .beidou_satellites import NOT_GEO
from .bits import PAGE_BITS, Field, Layout, layout
from .broadcast import Contents
from .ephemeris import D1

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .broadcast import Broadcast
    from .records import Frame

PAGES, EXPANDED_CYCLES = 24, 3
PAGED = 4
"""Subframes from this one on have pages."""
WEEK = Field("WN", ((61, 13),))
CLOCK = layout(
    ("health", "43"),
    ("iodc", "44-48"),
    ("accuracy", "49-52"),
    ("toc", "74-82 91-98", 8),
    ("tgd1", "99-108", 1e-10),
    ("tgd2", "109-112 121-126", 1e-10),
    ("a2", "215-225", 2.0**-66),
    ("a0", "226-232 241-257", 2.0**-33),
    ("a1", "258-262 271-287", 2.0**-50),
    ("iode", "288-292"),
    signed="tgd1 tgd2 a0 a1 a2",
)
KLOBUCHAR = layout(
    ("alpha0", "127-134", 2.0**-30),
    ("alpha1", "135-142", 2.0**-27),
    ("alpha2", "151-158", 2.0**-24),
    ("alpha3", "159-166", 2.0**-24),
    ("beta0", "167-172 181-182", 2.0**11),
    ("beta1", "183-190", 2.0**14),
    ("beta2", "191-198", 2.0**16),
    ("beta3", "199-202 211-214", 2.0**16),
    signed="alpha0 alpha1 alpha2 alpha3 beta0 beta1 beta2 beta3",
)
ORBIT_2 = layout(
    ("delta_n", "43-52 61-66", keplerian.RATE),
    ("cuc", "67-82 91-92", 2.0**-31),
    ("m0", "93-112 121-132", keplerian.ANGLE),
    ("e", "133-142 151-172", 2.0**-33),
    ("cus", "181-198", 2.0**-31),
    ("crc", "199-202 211-224", 2.0**-6),
    ("crs", "225-232 241-250", 2.0**-6),
    ("sqrt_a", "251-262 271-290", 2.0**-19),
    signed="delta_n cuc m0 cus crc crs",
)
ORBIT_3 = layout(
    ("i0", "66-82 91-105", keplerian.ANGLE),
    ("cic", "106-112 121-131", 2.0**-31),
    ("omega_dot", "132-142 151-163", keplerian.RATE),
    ("cis", "164-172 181-189", 2.0**-31),
    ("i_dot", "190-202 211", keplerian.RATE),
    ("omega0", "212-232 241-251", keplerian.ANGLE),
    ("omega", "252-262 271-291", keplerian.ANGLE),
    signed="i0 cic omega_dot cis i_dot omega0 omega",
)
TOE_HIGH, TOE_LOW = Field("toe", ((291, 2),)), Field("toe", ((43, 10), (61, 5)))
TOE_STEP_S, TOE_LOW_BITS = 8, 15
"""toe: 2 bits at the end of subframe 2, 15 at the start of subframe 3."""
PLACES = {
    1: CLOCK.places(PAGE_BITS),
    2: Layout((*ORBIT_2.fields, TOE_HIGH)).places(PAGE_BITS),
    3: Layout((*ORBIT_3.fields, TOE_LOW)).places(PAGE_BITS),
}
"""Bits of the ephemeris, by subframe."""


def slot(number: int, page: int) -> Slot:
    """What a page of subframe 4 or 5 holds (tables 5-8 and 5-9)."""
    if number == PAGED:
        return Slot("almanac", page)
    if page <= 6:
        return Slot("almanac", 24 + page)
    if page <= 10:
        fixed = (Slot("health", 1, 19), Slot("dated health", 20, 11), Slot("offsets"), Slot("utc"))
        return fixed[page - 7]
    return Slot("expanded", page - 11) if page < PAGES else Slot("expanded health")


class D1Message(BeidouMessage):
    """Encode and decode D1."""

    name = D1
    symbol_s = 0.02
    log10_chance = -1.92
    """A random time of 20 bits is a whole multiple of 6 s in the week, and the number agrees."""
    week_field = WEEK

    def sent_on(self, signal: str, prn: int) -> bool:
        """B1I, all but geostationary ones."""
        return signal == SIGNAL and prn in NOT_GEO

    def index(self, sow: int, number: int) -> int | None:
        """Count of subframes since the start of the week, if they go together."""
        index, rest = divmod(sow, 6)
        return None if rest or sow >= 604_800 or number != index % 5 + 1 else index

    def begins(self, index: int) -> tuple[int, float]:
        """Start of a subframe."""
        return 6 * index, 0.0

    def sow(self, index: int) -> int:
        """Each subframe tells its own start."""
        return 6 * index

    def page(self, index: int, bits: NDArray[np.uint8]) -> int:
        """Page of subframes 4 and 5."""
        return PAGE.raw(bits) if index % 5 + 1 >= PAGED else 0

    def tells_week(self, number: int, page: int) -> bool:
        """Subframe 1."""
        return number == 1

    def fill(self, bits: NDArray[np.uint8], content: Broadcast, index: int, week: int) -> None:
        """Write a subframe."""
        number, frame = index % 5 + 1, index // 5
        fields = keplerian.values(content.ephemeris)
        if number == 1:
            delay = content.ephemeris.group_delay_s
            CLOCK.write(bits, fields | {"tgd1": delay("B1I"), "tgd2": delay("B2I")})
            WEEK.write(bits, week % 8192)
            if content.klobuchar is not None:
                KLOBUCHAR.write(bits, content.klobuchar.fields())
        elif number == 2:
            ORBIT_2.write(bits, fields)
            TOE_HIGH.write(bits, round(fields["toe"] / TOE_STEP_S) >> TOE_LOW_BITS)
        elif number == 3:
            ORBIT_3.write(bits, fields)
            TOE_LOW.write(bits, round(fields["toe"] / TOE_STEP_S) % (1 << TOE_LOW_BITS))
        else:
            page, group = frame % PAGES + 1, frame // PAGES % EXPANDED_CYCLES + 1
            PAGE.write(bits, page)
            now = self.start(week, index)
            beidou_pages.fill(bits, slot(number, page), group, content, now)

    def said(self, frame: Frame, latest: dict[int, Frame]) -> Contents:
        """Subframes 1 to 3 are an ephemeris, 1 has the ionosphere too, the others have pages."""
        if frame.number >= PAGED:
            if not 1 <= frame.page <= PAGES:
                return Contents()
            place = slot(frame.number, frame.page)
            return beidou_pages.read(frame.bits, place, D1, frame.transmitted)
        gather(latest, frame.number, frame, PLACES[frame.number])
        orbit = self._orbit(latest)
        return ionosphere(KLOBUCHAR, frame) + orbit if frame.number == 1 else orbit

    def _orbit(self, latest: dict[int, Frame]) -> Contents:
        """Ephemeris of the last subframes 1 to 3, if they are of one set."""
        if len(latest) < 3:
            return Contents()
        first, second, third = (latest[n].bits for n in (1, 2, 3))
        fields = CLOCK.read(first) | ORBIT_2.read(second) | ORBIT_3.read(third)
        toe = TOE_HIGH.raw(second) << TOE_LOW_BITS | TOE_LOW.raw(third)
        fields["toe"] = toe * TOE_STEP_S
        times = [f.transmitted for f in latest.values()]
        if not together(times, same_reference=fields["toe"] == fields["toc"]):
            return Contents()
        return legacy_ephemeris(latest[1].prn, D1, fields, min(times))
