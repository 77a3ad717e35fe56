"""How subframes of D1 and D2 are told from random symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import bch15
from .bits import Field
from .sync import word_chances

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

PREAMBLE = np.array([1, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0], dtype=np.uint8)
"""BDS-SIS-ICD-B1I-3.0, 5.2.4.1."""
NUMBER = Field("FraID", ((16, 3),))
SOW = Field("SOW", ((19, 8), (31, 12)))
HEAD_BLOCKS = 3
"""Blocks with time and number."""
NO_CODEWORD = 15 / 16
"""Share of random blocks."""


class BeidouFraming:
    """Subframes of D1 or D2, see :class:`sdr_spoof.nav.sync.Framing`."""

    preamble = PREAMBLE
    head = 60

    def __init__(
        self, index: Callable[[int, int], int | None], log10_chance: float, noise: float
    ) -> None:
        """``index`` of time and number; ``noise`` of symbols of amplitude 1."""
        self.index = index
        self.log10_chance = log10_chance
        self.noise = noise

    def chances(self, soft: NDArray[np.float32], length: NDArray[np.intp]) -> NDArray[np.float64]:
        """log10 of the chance that random blocks have so few errors."""
        hard = (soft < 0).astype(np.uint8)
        ones = hard[:, bch15.SENT].sum(axis=2)
        # Bits that are all the same are codewords wherever a block is taken to begin.
        telling = (ones > 0) & (ones < bch15.LENGTH)
        whole = (bch15.SENT.max(axis=1) < length[:, None]) & telling
        wrong = bch15.wrong_blocks(hard) & whole
        table = word_chances(len(bch15.SENT), NO_CODEWORD)
        return np.asarray(table[whole.sum(axis=1), wrong.sum(axis=1)])

    def indices(self, soft: NDArray[np.float32], most_doubt: float) -> list[int | None]:
        """Which subframes they are."""
        decoded = bch15.decode(soft, self.noise)
        sure = decoded.doubt[:, :HEAD_BLOCKS].sum(axis=1) <= most_doubt * HEAD_BLOCKS
        return [
            self.index(SOW.raw(bits), NUMBER.raw(bits)) if good else None
            for bits, good in zip(decoded.bits, sure, strict=True)
        ]
