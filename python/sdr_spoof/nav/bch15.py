"""BCH(15,11) and the words of D1 and D2 that are made of it; the arithmetic is in the core.

Source: BDS-SIS-ICD-B1I-3.0, 5.1.3: word 1 of a subframe has 15 bits that are not coded and one
block, words 2 to 10 have two blocks, interleaved bit by bit. Hard decisions never tell that they
are wrong; soft ones take the codeword of largest correlation among those up to three errors away,
and tell the probability that it is wrong.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from .soft import Decoded

if TYPE_CHECKING:
    from numpy.typing import NDArray

LENGTH, INFORMATION = 15, 11
SUBFRAME = 300
SENT, PLACES = _core.d1_layout()
"""Where the 19 blocks of a subframe lie in its symbols as they are sent, (19, 15), and where their
bits lie in the subframe as the ICD numbers it."""


def encode(bits: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Symbols (F, 300), +1 or -1, of subframes (F, 300) in the ICD's order.

    The parity bits of ``bits`` are filled in.
    """
    bits[:], sent = _core.d1_encode(np.ascontiguousarray(bits))
    return (1 - 2 * sent.astype(np.int8)).astype(np.int8)


def wrong_blocks(hard: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Which of the 19 blocks of subframes (F, 300), as sent, are no codewords: (F, 19)."""
    return _core.d1_wrong_blocks(np.ascontiguousarray(hard))


def decode(soft: NDArray[np.float32], noise: float) -> Decoded:
    """Most likely codewords of subframes (F, 300) as sent, signs resolved.

    ``noise`` is the standard deviation of a symbol of amplitude 1.
    """
    return Decoded(*_core.d1_decode(np.ascontiguousarray(soft, np.float32), noise))


def correct(hard: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Bits of subframes (F, 300) as sent, one error of each block repaired."""
    return _core.d1_correct(np.ascontiguousarray(hard))[0]
