"""LNAV, the message of GPS L1 C/A, 50 bps.

Source: IS-GPS-200, 20.3: frames of 30 s, of 5 subframes, from the start of the week on. Subframes
1 to 3 repeat; 4 and 5 have 25 pages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import keplerian, lnav_pages, lnav_words
from .bits import PAGE_BITS, Field, layout
from .broadcast import Contents
from .ephemeris import LNAV
from .subframes import SubframeMessage
from .sync import word_chances

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .broadcast import Broadcast
    from .ephemeris import Ephemeris
    from .records import Frame
    from .sync import Found

SIGNAL = "L1CA"
PRNS = range(1, 33)
SUBFRAME_S = 6
PER_WEEK = 604_800 // SUBFRAME_S
PREAMBLE = np.array([1, 0, 0, 0, 1, 0, 1, 1], dtype=np.uint8)
"""20.3.3.1."""
TOW = Field("TOW", ((31, 17),))
"""Of the start of the next subframe, in 6 s."""
NUMBER = Field("subframe ID", ((50, 3),))
WEEK = Field("WN", ((61, 10),))
CLOCK = layout(
    ("accuracy", "73-76"),
    ("health", "77-82"),
    ("iodc", "83-84 211-218"),
    ("tgd", "197-204", 2.0**-31),
    ("toc", "219-234", 16),
    ("a2", "241-248", 2.0**-55),
    ("a1", "249-264", 2.0**-43),
    ("a0", "271-292", 2.0**-31),
    signed="tgd a2 a1 a0",
)
CODES = Field("codes on L2", ((71, 2),))
ORBIT_2 = layout(
    ("iode", "61-68"),
    ("crs", "69-84", 2.0**-5),
    ("delta_n", "91-106", keplerian.RATE),
    ("m0", "107-114 121-144", keplerian.ANGLE),
    ("cuc", "151-166", 2.0**-29),
    ("e", "167-174 181-204", 2.0**-33),
    ("cus", "211-226", 2.0**-29),
    ("sqrt_a", "227-234 241-264", 2.0**-19),
    ("toe", "271-286", 16),
    ("long fit", "287"),
    signed="crs delta_n m0 cuc cus",
)
ORBIT_3 = layout(
    ("cic", "61-76", 2.0**-29),
    ("omega0", "77-84 91-114", keplerian.ANGLE),
    ("cis", "121-136", 2.0**-29),
    ("i0", "137-144 151-174", keplerian.ANGLE),
    ("crc", "181-196", 2.0**-5),
    ("omega", "197-204 211-234", keplerian.ANGLE),
    ("omega_dot", "241-264", keplerian.RATE),
    ("iode", "271-278"),
    ("i_dot", "279-292", keplerian.RATE),
    signed="cic omega0 cis i0 crc omega omega_dot i_dot",
)
HEAD_WORDS = 2
"""Words with preamble, time and number."""
NORMAL_FIT_S, LONG_FIT_S = 7200.0, 10_800.0
FAILS_BY_CHANCE = 63 / 64
"""Share of random words."""


class LnavFraming:
    """Subframes of LNAV, see :class:`sdr_spoof.nav.sync.Framing`."""

    preamble = PREAMBLE
    head = 60
    log10_chance = -1.02
    """A random time of 17 bits is in the week, and a number of 3 bits is the one that goes with it.
    """

    def __init__(self, noise: float) -> None:
        """``noise`` of symbols of amplitude 1."""
        self.noise = noise

    def chances(self, soft: NDArray[np.float32], length: NDArray[np.intp]) -> NDArray[np.float64]:
        """log10 of the chance that so few random words fail."""
        hard = (soft < 0).astype(np.uint8)
        ends = np.arange(1, lnav_words.WORDS + 1) * lnav_words.WORD
        ones = hard.reshape(len(hard), -1, lnav_words.WORD).sum(axis=2)
        # Bits that are all the same pass wherever a word is taken to begin.
        telling = (ones > 0) & (ones < lnav_words.WORD)
        whole = (ends <= length[:, None]) & telling
        wrong = lnav_words.failing(hard) & whole
        table = word_chances(lnav_words.WORDS, FAILS_BY_CHANCE)
        return np.asarray(table[whole.sum(axis=1), wrong.sum(axis=1)])

    def indices(self, soft: NDArray[np.float32], most_doubt: float) -> list[int | None]:
        """Which subframes they are."""
        decoded = lnav_words.decode(soft, self.noise)
        sure = decoded.doubt[:, :HEAD_WORDS].sum(axis=1) <= most_doubt * HEAD_WORDS
        return [
            _index(TOW.raw(bits), NUMBER.raw(bits)) if good else None
            for bits, good in zip(decoded.bits, sure, strict=True)
        ]


def _index(count: int, number: int) -> int | None:
    """Subframe since the start of the week; its time is that of the next one."""
    index = (count - 1) % PER_WEEK
    return index if count < PER_WEEK and number == index % 5 + 1 else None


class LnavMessage(SubframeMessage):
    """Encode and decode LNAV."""

    name = LNAV
    system = "G"
    symbol_s = 0.02
    week_field = WEEK
    preamble = PREAMBLE

    def sent_on(self, signal: str, prn: int) -> bool:
        """L1 C/A of GPS."""
        return signal == SIGNAL and prn in PRNS

    def begins(self, index: int) -> tuple[int, float]:
        """Start of a subframe."""
        return index * SUBFRAME_S, 0.0

    def page(self, index: int, bits: NDArray[np.uint8]) -> int:
        """SV (page) ID of subframes 4 and 5."""
        return lnav_pages.PAGE_ID.raw(bits) if index % 5 >= 3 else 0

    def tells_week(self, number: int, page: int) -> bool:
        """Subframe 1."""
        return number == 1

    def to_symbols(self, bits: NDArray[np.uint8]) -> NDArray[np.int8]:
        """Symbols of subframes."""
        return lnav_words.encode(bits)

    def framing(self, noise: float) -> LnavFraming:
        """How subframes are told."""
        return LnavFraming(noise)

    def correct(
        self, soft: NDArray[np.float32], noise: float
    ) -> tuple[NDArray[np.uint8], NDArray[np.intp], NDArray[np.float64]]:
        """Most likely bits."""
        decoded = lnav_words.decode(soft, noise)
        return decoded.bits, decoded.corrected, decoded.doubt

    def failing(self, hard: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Which words fail with either sign."""
        return np.asarray(lnav_words.failing(hard) & lnav_words.failing(1 - hard))

    def whole(self, found: list[Found], values: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Which are there to the end; a change of sign within fails the parity."""
        return np.array([f.start + PAGE_BITS <= values.size for f in found], dtype=bool)

    def head(self, bits: NDArray[np.uint8], index: int) -> None:
        """Write time and number of a subframe."""
        TOW.write(bits, (index + 1) % PER_WEEK)
        NUMBER.write(bits, index % 5 + 1)

    def fill(self, bits: NDArray[np.uint8], content: Broadcast, index: int, week: int) -> None:
        """Write a subframe."""
        number = index % 5 + 1
        e = content.ephemeris
        if number <= 3:
            fields = keplerian.values(e) | {
                "tgd": e.group_delay_s("L1CA"),
                "iode": e.iode % 256,
                "long fit": e.fit_interval_s > NORMAL_FIT_S,
            }
            (CLOCK, ORBIT_2, ORBIT_3)[number - 1].write(bits, fields)
            if number == 1:
                WEEK.write(bits, week % 1024)
                CODES.write(bits, 1)
            return
        page = index // 5 % lnav_pages.PAGES + 1
        now = self.start(week, index)
        lnav_pages.fill(bits, lnav_pages.slot(number, page), content, now)

    def said(self, frame: Frame, latest: dict[int, Frame]) -> Contents:
        """Subframes 1 to 3 are an ephemeris, the others have pages."""
        if frame.number >= 4:
            return lnav_pages.read(frame.bits, frame.transmitted)
        latest[frame.number] = frame
        orbit = _orbit(latest) if len(latest) == 3 else None
        return Contents(ephemerides=() if orbit is None else (orbit,))


def _orbit(latest: dict[int, Frame]) -> Ephemeris | None:
    """Ephemeris of the last subframes 1 to 3, if they are of one issue."""
    clock, second, third = (
        part.read(latest[n].bits) for n, part in ((1, CLOCK), (2, ORBIT_2), (3, ORBIT_3))
    )
    if not int(clock["iodc"]) % 256 == int(second["iode"]) == int(third["iode"]):
        return None
    fields = clock | second | third
    if fields["sqrt_a"] == 0.0:
        return None
    return keplerian.ephemeris(
        "G",
        latest[1].prn,
        LNAV,
        fields,
        min(f.transmitted for f in latest.values()),
        group_delays_s=(("L1CA", fields["tgd"]),),
        fit_interval_s=LONG_FIT_S if fields["long fit"] else NORMAL_FIT_S,
    )
