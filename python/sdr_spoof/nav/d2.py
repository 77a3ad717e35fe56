"""D2, the message of geostationary BDS satellites on B1I, 500 bps.

Source: BDS-SIS-ICD-B1I-3.0, 5.3: frames of 3 s, of 5 subframes of 0.6 s. Subframe 1 has the basic
information on 10 pages, in words 1 to 5; subframes 2 to 4 judge other satellites, on 6 pages
(:mod:`.d2_integrity`); subframe 5 has 120 pages, among them the almanacs. The
time of week is that of the frame's start.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import beidou_pages, d2_integrity, keplerian
from .beidou import SIGNAL, BeidouMessage, gather, ionosphere, legacy_ephemeris, together
from .beidou_pages import PAGE, Slot
from .beidou_satellites import GEO
from .bits import PAGE_BITS, Field, layout
from .broadcast import Contents
from .ephemeris import D2

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .broadcast import Broadcast
    from .records import Frame

FRAME_S, SUBFRAME_S = 3, 0.6
BASIC_PAGES, PAGES = 10, 120
EXPANDED_CYCLES = 3
BASIC_PAGE = Field("Pnum1", ((43, 4),))
INTEGRITY_PAGE = Field("Pnum2", ((44, 4),))
"""Of subframe 2; subframes 3 and 4 go with it and have none."""
WEEK = Field("WN", ((65, 13),))
BASIC = layout(
    ("health", "1:47"),
    ("iodc", "1:48-52"),
    ("accuracy", "1:61-64"),
    ("toc", "1:78-82 1:91-102", 8),
    ("tgd1", "1:103-112", 1e-10),
    ("tgd2", "1:121-130", 1e-10),
    ("a0", "3:101-112 3:121-132", 2.0**-33),
    ("a1", "3:133-136 4:47-52 4:61-72", 2.0**-50),
    ("a2", "4:73-82 4:91", 2.0**-66),
    ("iode", "4:92-96"),
    ("delta_n", "4:97-112", keplerian.RATE),
    ("cuc", "4:121-134 5:47-50", 2.0**-31),
    ("m0", "5:51-52 5:61-82 5:91-98", keplerian.ANGLE),
    ("cus", "5:99-112 5:121-124", 2.0**-31),
    ("e", "5:125-134 6:47-52 6:61-76", 2.0**-33),
    ("sqrt_a", "6:77-82 6:91-112 6:121-124", 2.0**-19),
    ("cic", "6:125-134 7:47-52 7:61-62", 2.0**-31),
    ("cis", "7:63-80", 2.0**-31),
    ("toe", "7:81-82 7:91-105", 8),
    ("i0", "7:106-112 7:121-134 8:47-52 8:61-65", keplerian.ANGLE),
    ("crc", "8:66-82 8:91", 2.0**-6),
    ("crs", "8:92-109", 2.0**-6),
    ("omega_dot", "8:110-112 8:121-136 9:47-51", keplerian.RATE),
    ("omega0", "9:52 9:61-82 9:91-99", keplerian.ANGLE),
    ("omega", "9:100-112 9:121-134 10:47-51", keplerian.ANGLE),
    ("i_dot", "10:52 10:61-73", keplerian.RATE),
    signed="tgd1 tgd2 a0 a1 a2 delta_n cuc m0 cus cic cis i0 crc crs omega_dot omega0 omega i_dot",
)
PLACES = BASIC.places(BASIC_PAGES * PAGE_BITS).reshape(BASIC_PAGES, PAGE_BITS)
"""Bits of the ephemeris, by page."""
KLOBUCHAR = layout(
    ("alpha0", "47-52 61-62", 2.0**-30),
    ("alpha1", "63-70", 2.0**-27),
    ("alpha2", "71-78", 2.0**-24),
    ("alpha3", "79-82 91-94", 2.0**-24),
    ("beta0", "95-102", 2.0**11),
    ("beta1", "103-110", 2.0**14),
    ("beta2", "111-112 121-126", 2.0**16),
    ("beta3", "127-134", 2.0**16),
    signed="alpha0 alpha1 alpha2 alpha3 beta0 beta1 beta2 beta3",
)
CLOCK_PAGE, IONOSPHERE_PAGE = 1, 2


def slot(page: int) -> Slot:
    """What a page of subframe 5 holds (table 5-18)."""
    single = {
        35: Slot("health", 1, 19),
        36: Slot("dated health", 20, 11),
        101: Slot("offsets"),
        102: Slot("utc"),
        116: Slot("expanded health"),
    }
    if page in single:
        return single[page]
    ranges = ((37, 60, "almanac", 1), (95, 100, "almanac", 25), (103, 115, "expanded", 0))
    for first, last, kind, satellite in ranges:
        if first <= page <= last:
            return Slot(kind, satellite + page - first)
    return Slot("grid" if 1 <= page <= 13 or 61 <= page <= 73 else "")


class D2Message(BeidouMessage):
    """Encode and decode D2."""

    name = D2
    symbol_s = 0.002
    log10_chance = -0.92
    """A random time of 20 bits is a whole multiple of 3 s in the week, and a number from 1 to 5."""
    week_field = WEEK

    def sent_on(self, signal: str, prn: int) -> bool:
        """B1I, geostationary ones."""
        return signal == SIGNAL and prn in GEO

    def index(self, sow: int, number: int) -> int | None:
        """Count of subframes since the start of the week, if they go together."""
        frame, rest = divmod(sow, FRAME_S)
        fits = rest == 0 and sow < 604_800 and 1 <= number <= 5
        return 5 * frame + number - 1 if fits else None

    def begins(self, index: int) -> tuple[int, float]:
        """Start of a subframe."""
        return self.sow(index), SUBFRAME_S * (index % 5)

    def sow(self, index: int) -> int:
        """All subframes of a frame tell its start."""
        return index // 5 * FRAME_S

    def page(self, index: int, bits: NDArray[np.uint8]) -> int:
        """Page of subframes 1 and 5, and of the integrity."""
        number = index % 5 + 1
        field = {1: BASIC_PAGE, 2: INTEGRITY_PAGE, 5: PAGE}.get(number)
        return 0 if field is None else field.raw(bits)

    def tells_week(self, number: int, page: int) -> bool:
        """Page 1 of subframe 1."""
        return number == 1 and page == CLOCK_PAGE

    def fill(self, bits: NDArray[np.uint8], content: Broadcast, index: int, week: int) -> None:
        """Write a subframe."""
        number, frame = index % 5 + 1, index // 5
        if number == 1:
            self._fill_basic(bits, content, frame % BASIC_PAGES + 1, week)
        elif number == 5:
            page, group = frame % PAGES + 1, frame // PAGES % EXPANDED_CYCLES + 1
            now = self.start(week, index)
            beidou_pages.fill(bits, slot(page), group, content, now)
            d2_integrity.fill_grid(bits, page, content.grid)
            PAGE.write(bits, page)
        else:
            page = frame % d2_integrity.PAGES + 1
            d2_integrity.fill(bits, number, page, content.integrity)
            if number == 2:
                INTEGRITY_PAGE.write(bits, page)

    @staticmethod
    def _fill_basic(bits: NDArray[np.uint8], content: Broadcast, page: int, week: int) -> None:
        pages = np.zeros(BASIC_PAGES * PAGE_BITS, dtype=np.uint8)
        delay = content.ephemeris.group_delay_s
        delays = {"tgd1": delay("B1I"), "tgd2": delay("B2I")}
        BASIC.write(pages, keplerian.values(content.ephemeris) | delays)
        start = (page - 1) * PAGE_BITS
        bits[46:] |= pages[start + 46 : start + PAGE_BITS]
        BASIC_PAGE.write(bits, page)
        if page == CLOCK_PAGE:
            WEEK.write(bits, week % 8192)
        if page == IONOSPHERE_PAGE and content.klobuchar is not None:
            KLOBUCHAR.write(bits, content.klobuchar.fields())

    def read(self, frames: Sequence[Frame]) -> Contents:
        """As others, and how other satellites are judged."""
        return super().read(frames) + d2_integrity.read(frames)

    def said(self, frame: Frame, latest: dict[int, Frame]) -> Contents:
        """Pages of subframe 1 are an ephemeris and the ionosphere, subframe 5 has other pages."""
        if frame.number == 5 and d2_integrity.points(frame.page):
            return d2_integrity.read_grid(frame.bits, frame.page, frame.transmitted)
        if frame.number == 5:
            return beidou_pages.read(frame.bits, slot(frame.page), D2, frame.transmitted)
        if frame.number != 1 or not 1 <= frame.page <= BASIC_PAGES:
            return Contents()
        if frame.page == IONOSPHERE_PAGE:
            return ionosphere(KLOBUCHAR, frame)
        gather(latest, frame.page, frame, PLACES[frame.page - 1])
        return self._orbit(latest)

    @staticmethod
    def _orbit(latest: dict[int, Frame]) -> Contents:
        """Ephemeris of the last pages of subframe 1, if they are of one set."""
        if len(latest) < BASIC_PAGES - 1:
            return Contents()
        bits = np.zeros(BASIC_PAGES * PAGE_BITS, dtype=np.uint8)
        for page, frame in latest.items():
            bits[(page - 1) * PAGE_BITS : page * PAGE_BITS] = frame.bits
        fields, times = BASIC.read(bits), [f.transmitted for f in latest.values()]
        if not together(times, same_reference=fields["toe"] == fields["toc"]):
            return Contents()
        return legacy_ephemeris(latest[CLOCK_PAGE].prn, D2, fields, min(times))
