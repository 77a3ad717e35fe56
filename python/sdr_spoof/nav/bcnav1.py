"""B-CNAV1, the message of BDS-3 satellites in medium and inclined orbits on B1C, 100 sps.

Source: BDS-SIS-ICD-B1C-1.0, 6.2. A frame of 1800 symbols begins at each multiple of 18 s of the
week, together with the pilot's secondary code. Subframe 1 tells satellite and frame of the hour,
subframe 2 time, orbit and clock, subframe 3 a page of the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from ..errors import NavigationError
from . import bcnav1_fields as fields
from . import bcnav1_orbit, bcnav1_pages
from .beidou_satellites import GEO
from .bits import bits_of, number_of
from .broadcast import Contents
from .ephemeris import CNAV1
from .records import Frame
from .steps import LOSING_S, Reach
from .time import WEEK_S, GnssTime
from .weeks import full_week

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from .broadcast import Broadcast
    from .ephemeris import Ephemeris
    from .records import SymbolRun

    Bits = NDArray[np.uint8]

SIGNAL = "B1CD"
SYMBOL_S, FRAME_SYMBOLS, FIRST_SYMBOLS = 0.01, 1800, 72
FRAME_S, HOUR_S, WEEKS = 18, 3600, 8192
HOUR_FRAMES, WEEK_FRAMES = HOUR_S // FRAME_S, WEEK_S // FRAME_S
PRN_BITS, SOH_BITS, BITS_2, BITS_3, CHECK = 6, 8, 600, 264, 24
AT_2 = PRN_BITS + SOH_BITS
AT_3 = AT_2 + BITS_2
"""Where subframes 2 and 3 begin among the 878 bits of a frame: satellite, frame of the hour,
subframes 2 and 3 with their checks."""
STARTS = 3
"""Starts of frames that are tried where none is given."""
PRESENT_AT_LEAST = 0.5
"""Share of a frame below which nothing can be decoded: the codes double the bits."""


@dataclass(frozen=True)
class _Rows:
    """Frames cut from a run, of which there may be only a part at both ends."""

    first: int
    """Symbol of the run with which the first of them begins; may be negative."""
    values: NDArray[np.float32]
    """(F, 1800), right sign, zeros where the run has none."""
    inverted: NDArray[np.bool_]
    """(F,)."""
    soh: int
    """Frame of the hour that the first of them is, by subframes 1."""


class BCnav1Message:
    """Encode and decode B-CNAV1."""

    name = CNAV1

    def sent_on(self, signal: str, prn: int) -> bool:
        """B1C's data component, all but geostationary ones."""
        return signal == SIGNAL and prn not in GEO

    def encode(self, content: Broadcast, start: GnssTime, duration_s: float) -> NDArray[np.int8]:
        """Symbols +1 and -1, see :class:`sdr_spoof.nav.records.Message`."""
        week, tow = start.week_tow("C")
        place = tow / SYMBOL_S
        if abs(place - round(place)) > 1e-3:
            raise NavigationError(
                f"{self.name} cannot start at {tow:.6f} s of the week: begin at a whole multiple "
                f"of {SYMBOL_S} s"
            )
        first, skip = divmod(round(place), FRAME_SYMBOLS)
        count = math.ceil(duration_s / SYMBOL_S - 1e-6)
        orbit = bcnav1_orbit.values(content.ephemeris)
        indices = range(first, first + -(-(skip + count) // FRAME_SYMBOLS))
        frames = [_encode_frame(content, orbit, week, index) for index in indices]
        return np.concatenate([*frames, np.zeros(0, np.int8)])[skip : skip + count]

    def reach(self, run: SymbolRun, frame: Frame) -> Reach:
        """All of a run: the pilot, whose secondary code is as long as a frame, is lost when it is
        out of step."""
        begin_s, end_s = float(run.time_s[0]), float(run.time_s[-1]) + SYMBOL_S
        return Reach(run_from_s=begin_s, run_until_s=end_s - LOSING_S)

    def decode(
        self, run: SymbolRun, near: GnssTime | None = None, start: int | None = None
    ) -> list[Frame]:
        """Frames of a run, see :class:`sdr_spoof.nav.records.Message`; also those of which only a
        part was received, if it is enough.

        Args:
            run: symbols of the data component; of either sign, which may change between frames.
            near: tells which of the weeks that have the number sent.
            start: a symbol with which a frame begins, up to multiples of 1800, where it is known
                from the pilot's secondary code.
        """
        for rows in _candidates(run, start):
            decoded = _core.cnav1_decode(rows.values)
            frames = _frames(run, rows, decoded, near)
            if frames:
                return frames
        return []

    def read(self, frames: Sequence[Frame]) -> Contents:
        """Put together what the frames of one satellite say."""
        contents, health = Contents(), 0
        last: Ephemeris | None = None
        for frame in frames:
            if not frame.ok:
                continue
            second, third = frame.bits[AT_2:AT_3], frame.bits[AT_3:]
            if third.any():
                health = bcnav1_pages.health(third)
                contents += bcnav1_pages.read(third, frame.transmitted)
            if second.any():
                found = fields.SUBFRAME2.read(second)
                new = bcnav1_orbit.ephemeris(frame.prn, found, frame.transmitted, health)
                if new is not None and _differs(new, last):
                    contents += Contents(ephemerides=(new,))
                    last = new
        return contents


def _differs(new: Ephemeris, last: Ephemeris | None) -> bool:
    def identity(e: Ephemeris) -> tuple[object, ...]:
        return e.iode, e.iodc, e.toe, e.toc, e.health

    return last is None or identity(new) != identity(last)


def _encode_frame(
    content: Broadcast, orbit: dict[str, float], week: int, index: int
) -> NDArray[np.int8]:
    """Symbols of the frame of that index since the start of a week; weeks may be passed."""
    later, within = divmod(index, WEEK_FRAMES)
    hour, soh = divmod(within, HOUR_FRAMES)
    second = np.zeros(BITS_2 - CHECK, dtype=np.uint8)
    third = np.zeros(BITS_3 - CHECK, dtype=np.uint8)
    fields.SUBFRAME2.write(second, orbit | {"week": (week + later) % WEEKS, "how": hour})
    now = GnssTime.of_week(week + later, within * FRAME_S, "C")
    bcnav1_pages.fill(third, content, within, now)
    return _core.cnav1_encode(content.ephemeris.prn, soh, second, third)


def _candidates(run: SymbolRun, start: int | None) -> Iterator[_Rows]:
    """Ways to cut a run into frames, the likeliest first."""
    values = np.where(np.isfinite(run.values), run.values, 0.0).astype(np.float32)
    if start is not None:
        shift = start % FRAME_SYMBOLS
        # Where the start is given, the subframe 1 that is there tells the sign and the number.
        found = _core.cnav1_find(values[shift:], run.prn, FRAME_SYMBOLS)
        starts = [(shift, inverted, soh, 0.0) for at, inverted, soh, _ in found if at == 0]
    else:
        starts = _core.cnav1_find(values, run.prn, STARTS)
    for offset, inverted, soh, _ in starts:
        yield _cut(run.prn, values, offset, inverted, soh)


def _cut(prn: int, values: NDArray[np.float32], offset: int, inverted: bool, soh: int) -> _Rows:
    """Frames from the one before ``offset`` to the last that has begun."""
    before = -offset % FRAME_SYMBOLS
    count = -(-(before + values.size) // FRAME_SYMBOLS)
    rows = np.zeros((count, FRAME_SYMBOLS), dtype=np.float32)
    rows.reshape(-1)[before : before + values.size] = values
    number = (soh - (before > 0)) % HOUR_FRAMES
    signs = np.empty(count, dtype=np.float32)
    for n, row in enumerate(rows):
        first = _core.cnav1_first(prn, (number + n) % HOUR_FRAMES)
        agreement = float(row[:FIRST_SYMBOLS] @ first)
        signs[n] = math.copysign(1.0, agreement) if agreement else (-1.0 if inverted else 1.0)
    return _Rows(-before, rows * signs[:, None], signs < 0, number)


def _frames(
    run: SymbolRun, rows: _Rows, decoded: Sequence[_core.Cnav1Frame], near: GnssTime | None
) -> list[Frame]:
    """Frames of which a check holds, in order; none if no subframe 2 tells the time."""
    present = (rows.values != 0).mean(axis=1) >= PRESENT_AT_LEAST
    good = [n for n, d in enumerate(decoded) if present[n] and (d.ok2 or d.ok3)]
    named = [n for n in good if rows.values[n, :FIRST_SYMBOLS].any()]
    if 2 * sum(decoded[n].prn == run.prn for n in named) < len(named):
        return []  # another satellite's
    reference = _reference(rows, decoded, good, near)
    if reference is None:
        return []
    n0, time0 = reference
    return [_frame(run, rows, decoded[n], n, time0 + float(FRAME_S * (n - n0))) for n in good]


def _reference(
    rows: _Rows,
    decoded: Sequence[_core.Cnav1Frame],
    good: Sequence[int],
    near: GnssTime | None,
) -> tuple[int, GnssTime] | None:
    """The first frame whose subframe 2 holds, and when it was sent.

    Only that tells hour and week; frames of which subframe 3 alone holds count from it.
    """
    for n in good:
        if decoded[n].ok2:
            week, hour = _hour(decoded[n])
            within = hour * HOUR_FRAMES + (rows.soh + n) % HOUR_FRAMES
            return n, GnssTime.of_week(full_week("C", week, near), within * FRAME_S, "C")
    return None


def _hour(decoded: _core.Cnav1Frame) -> tuple[int, int]:
    """Week, up to its rollover, and hour of the week in a subframe 2."""
    found = fields.SUBFRAME2.read(np.asarray(decoded.bits2))
    return int(found["week"]), int(found["how"])


def _contradicts(decoded: _core.Cnav1Frame, transmitted: GnssTime) -> bool:
    """Whether a frame tells another time than the first one and the count of symbols do."""
    week, tow = transmitted.week_tow("C")
    return decoded.ok2 and _hour(decoded) != (week % WEEKS, int(tow) // HOUR_S)


def _frame(
    run: SymbolRun,
    rows: _Rows,
    decoded: _core.Cnav1Frame,
    n: int,
    transmitted: GnssTime,
) -> Frame:
    """Record of a decoded frame; bits of a subframe that failed are zeros."""
    symbol = rows.first + n * FRAME_SYMBOLS
    step = run.code_phase_chips[1] - run.code_phase_chips[0]
    bits = np.zeros(AT_3 + BITS_3, dtype=np.uint8)
    bits[:PRN_BITS] = bits_of(run.prn, PRN_BITS)
    bits[PRN_BITS:AT_2] = bits_of((rows.soh + n) % HOUR_FRAMES, SOH_BITS)
    if decoded.ok2:
        bits[AT_2:AT_3] = decoded.bits2
    if decoded.ok3:
        bits[AT_3:] = decoded.bits3
    inside = min(max(symbol, 0), run.values.size - 1)
    return Frame(
        system="C",
        prn=run.prn,
        signal=run.signal,
        message=CNAV1,
        number=0,
        page=number_of(bits[AT_3 : AT_3 + 6]),
        transmitted=transmitted,
        bits=bits,
        code_phase_chips=float(run.code_phase_chips[inside] + (symbol - inside) * round(step)),
        time_s=float(run.time_s[inside] + (symbol - inside) * run.symbol_s),
        duration_s=float(FRAME_S),
        corrected=decoded.corrected2 * decoded.ok2 + decoded.corrected3 * decoded.ok3,
        ok=not _contradicts(decoded, transmitted),
        inverted=bool(rows.inverted[n]),
    )
