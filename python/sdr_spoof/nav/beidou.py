"""What D1 and D2 have in common.

Source: BDS-SIS-ICD-B1I-3.0, chapter 5. Bits are numbered as in its figures: 300 a subframe, words
of 30, information before parity.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from . import bch15, keplerian
from .beidou_framing import NUMBER, PREAMBLE, SOW, BeidouFraming
from .bits import PAGE_BITS
from .broadcast import Contents, Klobuchar
from .subframes import SubframeMessage
from .sync import preamble_errors

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from .bits import Layout
    from .records import Frame
    from .sync import Found
    from .time import GnssTime

SIGNAL = "B1I"
SET_S = 30.0
"""Subframes 1 to 3 of D1 with those between, and the pages of subframe 1 of D2, repeat so."""
CONFIRMED_BY = 8
"""Symbols of the next preamble that must be there to tell whether the sign stayed."""


class BeidouMessage(SubframeMessage):
    """Symbols to subframes of D1 or D2 and back."""

    system = "C"
    preamble = PREAMBLE
    log10_chance: float
    """Of a random time and number to go together."""

    @abstractmethod
    def index(self, sow: int, number: int) -> int | None:
        """Count of subframes since the start of the week; None where both do not go together."""

    @abstractmethod
    def sow(self, index: int) -> int:
        """Time of week that a subframe tells."""

    def head(self, bits: NDArray[np.uint8], index: int) -> None:
        """Write time and number of a subframe."""
        NUMBER.write(bits, index % 5 + 1)
        SOW.write(bits, self.sow(index))

    def to_symbols(self, bits: NDArray[np.uint8]) -> NDArray[np.int8]:
        """Symbols of subframes."""
        return bch15.encode(bits)

    def framing(self, noise: float) -> BeidouFraming:
        """How subframes are told."""
        return BeidouFraming(self.index, self.log10_chance, noise)

    def correct(
        self, soft: NDArray[np.float32], noise: float
    ) -> tuple[NDArray[np.uint8], NDArray[np.intp], NDArray[np.float64]]:
        """Most likely bits."""
        decoded = bch15.decode(soft, noise)
        return decoded.bits, decoded.corrected, decoded.doubt

    def failing(self, hard: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Which words fail: those of which one block does. An inverted block is a codeword too."""
        wrong = bch15.wrong_blocks(hard)
        return np.asarray(np.concatenate([wrong[:, :1], wrong[:, 1::2] | wrong[:, 2::2]], axis=1))

    def whole(self, found: list[Found], values: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Which are there to the end, with the sign that they began with.

        An inverted codeword is one too. Only the preamble of the next subframe shows that no half
        cycle was lost within.
        """
        padded = np.concatenate([values, np.zeros(PREAMBLE.size, np.float32)])
        errors = preamble_errors(padded, PREAMBLE)
        ends = np.array([f.start for f in found]) + PAGE_BITS
        missing = ends + PREAMBLE.size - values.size
        inside = missing <= PREAMBLE.size - CONFIRMED_BY
        same = np.array([f.sign for f in found]) > 0
        at = np.where(inside, ends, 0)
        wrong = np.where(same, errors[at], PREAMBLE.size - errors[at])
        # The majority tells; symbols beyond the end count as 0, and are too few to turn it.
        return np.asarray(inside & (wrong < PREAMBLE.size // 2))


def together(times: Sequence[GnssTime], *, same_reference: bool) -> bool:
    """Whether subframes of these times are of one set.

    A set takes 30 s, and new ones begin with the hour. They may begin elsewhere after an upload,
    with a frame: parts of two frames must then at least have the same time of reference for orbit
    and clock, which are in different parts.
    """
    one_frame = len({_set_of(t) for t in times}) == 1
    one_hour = len({t.week_tow("C")[1] // 3600 for t in times}) == 1
    within = max(times) - min(times) < SET_S and one_hour
    return within and (one_frame or same_reference)


def gather(latest: dict[int, Frame], key: int, frame: Frame, places: NDArray[np.bool_]) -> None:
    """Put a frame among those that an ephemeris is put together from.

    Nothing in D1 and D2 ties the parts of an ephemeris together: issues of age may stay the same
    from set to set. But where a part tells another thing than the last time, a new set has begun
    since, with a frame; so the others go that are not of the same frame.

    Args:
        latest: frames by number or page.
        key: that of this one.
        frame: the new one.
        places: its bits that belong to the ephemeris, (300,).
    """
    before = latest.get(key)
    if before is not None and not np.array_equal(before.bits[places], frame.bits[places]):
        old = [k for k, f in latest.items() if _set_of(f.transmitted) != _set_of(frame.transmitted)]
        for k in old:
            del latest[k]
    latest[key] = frame


def _set_of(time: GnssTime) -> float:
    """Which repetition of orbit and clock a time lies in."""
    return time.week_tow("C")[1] // SET_S


def ionosphere(layout: Layout, frame: Frame) -> Contents:
    """Klobuchar's model where a frame has it."""
    model = Klobuchar.of(layout.read(frame.bits).values(), "C", frame.transmitted)
    return Contents(ionosphere=(model,))


def legacy_ephemeris(
    prn: int, message: str, fields: Mapping[str, float], transmitted: GnssTime
) -> Contents:
    """Ephemeris of D1 or D2 fields; none where they are no orbit."""
    if fields["sqrt_a"] == 0.0:
        return Contents()
    delays = (("B1I", fields["tgd1"]), ("B2I", fields["tgd2"]))
    orbit = keplerian.ephemeris("C", prn, message, fields, transmitted, group_delays_s=delays)
    return Contents(ephemerides=(orbit,))
