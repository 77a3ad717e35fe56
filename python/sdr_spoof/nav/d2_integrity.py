"""Integrity in D2: subframes 2 to 4, six pages, and the grid of the ionosphere in subframe 5.

Source: BDS-SIS-ICD-B1I-3.0, 5.3.2 (places) and 5.3.3. Up to 18 of the satellites 1 to 30 and up to
6 of 31 to 63 are marked (BDID); each has a slot, in ascending order. All UDREI are on every page,
RURAI and correction of a slot on one: those of three slots of the first kind, in subframes 2 and 3,
and of one of the second, in subframe 4. Subframe 2 alone tells the page.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..errors import NavigationError
from . import bch15
from .bits import Field, Layout, layout
from .broadcast import Contents
from .integrity import IGPS, NOT_AVAILABLE, GridPoint, Integrity

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from .records import Frame
    from .time import GnssTime

PAGES = 6
FIRST, SECOND = range(1, 31), range(31, 64)
SLOTS, MORE_SLOTS, SLOTS_A_PAGE = 18, 6, 3
HEALTH = Field("SatH2", ((48, 2),))
RANGES_WRONG, GRID_WRONG = 0b10, 0b01
"""SatH2: what the satellite itself found wrong with what it was given to send."""
MARKS = Field("BDID", ((50, 3), (61, 22), (91, 5)))
MORE_MARKS = Field("BDID", ((171, 2), (181, 22), (211, 9)))
EXPANDED = Field("BDEpID", ((169, 2),))
"""3 where subframe 4 is about satellites 31 to 63."""
EXPANDED_SENT = 3
CORRECTION_M, NO_CORRECTION = 0.1, -4096
"""Step, and the integer that says that there is none."""


def _consecutive(first: int, width: int, count: int) -> tuple[tuple[tuple[int, int], ...], ...]:
    """Places of values one after the other, parity left out."""
    free = [b for b in range(first, bch15.SUBFRAME + 1) if (b - 1) % 30 < 22]
    return tuple(tuple((b, 1) for b in free[width * n : width * n + width]) for n in range(count))


UDREI = [Field("UDREI", at) for at in _consecutive(172, 4, SLOTS)]
MORE_UDREI = [Field("UDREI", at) for at in _consecutive(220, 4, MORE_SLOTS)]
SLOT_2 = layout(("rurai", "276-279"), ("correction", "280-292"), signed="correction")
SLOTS_3 = (
    layout(("rurai", "44-47"), ("correction", "48-52 61-68"), signed="correction"),
    layout(("rurai", "69-72"), ("correction", "73-82 91-93"), signed="correction"),
)
SLOT_4 = layout(("rurai", "252-255"), ("correction", "256-262 271-276"), signed="correction")
GRID_BITS, DELAY_BITS, POINTS_A_PAGE, POINTS_LAST = 13, 9, 13, 4
POINTS = [Field("Ion", at) for at in _consecutive(51, GRID_BITS, POINTS_A_PAGE)]
DELAY_M, NO_DELAY, LARGEST = 0.125, 0x1FF, 509
"""Step of a delay; 510: not monitored, 511: not available."""


def slots(integrity: Sequence[Integrity]) -> tuple[list[Integrity], list[Integrity]]:
    """Satellites 1 to 30 and 31 to 63, by slot.

    Raises:
        NavigationError: there are more than slots.
    """
    ordered = sorted(integrity, key=lambda i: i.prn)
    first = [i for i in ordered if i.prn in FIRST]
    second = [i for i in ordered if i.prn in SECOND]
    if len(first) > SLOTS or len(second) > MORE_SLOTS:
        raise NavigationError(
            f"D2 tells the integrity of {SLOTS} satellites up to C30 and {MORE_SLOTS} from C31 on "
            f"at most, not of {len(first)} and {len(second)}; name fewer"
        )
    return first, second


def fill(bits: NDArray[np.uint8], number: int, page: int, integrity: Sequence[Integrity]) -> None:
    """Write subframe 2, 3 or 4 of a page (1 to 6); nothing where nobody is judged."""
    first, second = slots(integrity)
    at = SLOTS_A_PAGE * (page - 1)
    if number == 2:
        _mark(bits, MARKS, first, FIRST)
        _indices(bits, UDREI, first)
        _slot(bits, SLOT_2, first, at)
    elif number == 3:
        _slot(bits, SLOTS_3[0], first, at + 1)
        _slot(bits, SLOTS_3[1], first, at + 2)
    elif second:
        EXPANDED.write(bits, EXPANDED_SENT)
        _mark(bits, MORE_MARKS, second, SECOND)
        _indices(bits, MORE_UDREI, second)
        _slot(bits, SLOT_4, second, page - 1)


def _mark(bits: NDArray[np.uint8], marks: Field, judged: Sequence[Integrity], prns: range) -> None:
    marks.write(bits, sum(1 << (prns.stop - 1 - i.prn) for i in judged))


def _indices(bits: NDArray[np.uint8], fields: list[Field], judged: Sequence[Integrity]) -> None:
    for field, satellite in zip(fields, judged, strict=False):
        field.write(bits, satellite.udrei)


def _slot(bits: NDArray[np.uint8], place: Layout, judged: Sequence[Integrity], at: int) -> None:
    if at >= len(judged):
        return
    meters = judged[at].correction_m
    correction = NO_CORRECTION if math.isnan(meters) else round(meters / CORRECTION_M)
    place.write(bits, {"rurai": judged[at].rurai, "correction": correction})


def points(page: int) -> range:
    """Grid points of a page of subframe 5; none on others."""
    for first, igp in ((1, 1), (61, 1 + IGPS // 2)):
        if first <= page <= first + 12:
            start = igp + POINTS_A_PAGE * (page - first)
            return range(start, start + (POINTS_A_PAGE if page < first + 12 else POINTS_LAST))
    return range(0)


def fill_grid(bits: NDArray[np.uint8], page: int, grid: Sequence[GridPoint]) -> None:
    """Write the points of a page that are known over those that are not available."""
    known = {p.igp: p for p in grid if not math.isnan(p.delay_m)}
    for field, igp in zip(POINTS, points(page), strict=False):
        if igp in known:
            steps = min(max(round(known[igp].delay_m / DELAY_M), 0), LARGEST)
            field.write(bits, steps << 4 | known[igp].givei)


def read_grid(bits: NDArray[np.uint8], page: int, now: GnssTime) -> Contents:
    """Points of a page that are available."""
    found = []
    for field, igp in zip(POINTS, points(page), strict=False):
        steps, givei = divmod(field.raw(bits), 1 << 4)
        if steps != NO_DELAY:
            delay_m = steps * DELAY_M if steps <= LARGEST else math.nan
            found.append(GridPoint(igp, delay_m, givei, now))
    return Contents(grid=tuple(found))


class _Judged:
    """What was said so far, by slot."""

    def __init__(self, prns: range, count: int) -> None:
        self.prns = prns
        self.satellites: list[int] = []
        self.udrei = [NOT_AVAILABLE] * count
        self.slot: dict[int, tuple[int, float]] = {}

    def mark(self, marks: int) -> None:
        """Which satellites have slots; others than before: nothing is known of them."""
        satellites = [p for p in self.prns if marks >> (self.prns.stop - 1 - p) & 1]
        if satellites != self.satellites:
            self.satellites, self.slot = satellites, {}

    def tell(self, at: int, values: dict[str, float]) -> None:
        """RURAI and correction of a slot."""
        steps = int(values["correction"])
        meters = math.nan if steps == NO_CORRECTION else steps * CORRECTION_M
        self.slot[at] = (int(values["rurai"]), meters)

    def all(self, now: GnssTime) -> Iterator[Integrity]:
        """Those of which all is known."""
        for at, prn in enumerate(self.satellites[: len(self.udrei)]):
            if at in self.slot:
                rurai, meters = self.slot[at]
                yield Integrity(prn, self.udrei[at], rurai, meters, now)


def read(frames: Sequence[Frame]) -> Contents:
    """What subframes 2 to 4 of one satellite say, in order of time; changes only."""
    first, second = _Judged(FIRST, SLOTS), _Judged(SECOND, MORE_SLOTS)
    page, begun = 0, None
    found: list[Integrity] = []
    last: dict[int, Integrity] = {}
    for frame in frames:
        if not frame.ok or frame.number not in (2, 3, 4):
            continue
        bits, start = frame.bits, _frame(frame)
        if frame.number == 2:
            page, begun = frame.page, start
            if not 1 <= page <= PAGES or HEALTH.raw(bits) & RANGES_WRONG:
                page = 0
        if start != begun or not page:
            continue
        if frame.number == 2:
            first.mark(MARKS.raw(bits))
            first.udrei = [f.raw(bits) for f in UDREI]
            first.tell(SLOTS_A_PAGE * (page - 1), SLOT_2.read(bits))
        elif frame.number == 3:
            for n, place in enumerate(SLOTS_3):
                first.tell(SLOTS_A_PAGE * (page - 1) + n + 1, place.read(bits))
        elif EXPANDED.raw(bits) == EXPANDED_SENT:
            second.mark(MORE_MARKS.raw(bits))
            second.udrei = [f.raw(bits) for f in MORE_UDREI]
            second.tell(page - 1, SLOT_4.read(bits))
        for one in (*first.all(frame.transmitted), *second.all(frame.transmitted)):
            before = last.get(one.prn)
            if before is None or not _same(one, before):
                found.append(one)
                last[one.prn] = one
    return Contents(integrity=tuple(found))


def _frame(frame: Frame) -> int:
    """Number in the week of the frame of 3 s that a subframe is of."""
    return int(frame.transmitted.week_tow("C")[1] + 0.01) // 3


def _same(a: Integrity, b: Integrity) -> bool:
    plain = (
        replace(a, transmitted=None, correction_m=0.0),
        replace(b, transmitted=None, correction_m=0.0),
    )
    return plain[0] == plain[1] and str(a.correction_m) == str(b.correction_m)
