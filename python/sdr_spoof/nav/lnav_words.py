"""Words of LNAV: parity (32,26), most likely corrections.

Source: IS-GPS-200, 20.3.5.2, table 20-XIV. A word is 24 data and 6 parity bits; the last two bits
of the word before, D29* and D30*, enter its parity, and D30* inverts its data.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from .soft import Decoded, doubt

if TYPE_CHECKING:
    from numpy.typing import NDArray

WORD, DATA, WORDS = 30, 24, 10
_EQUATIONS = (
    (29, (1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23)),
    (30, (2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24)),
    (29, (1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22)),
    (30, (2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23)),
    (30, (1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24)),
    (29, (3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24)),
)
"""For D25 to D30: which of D29* and D30*, which data bits."""
SOLVED = (1, 9)
"""Words (from 0) whose last two data bits make their last two parity bits 0."""


def _matrices() -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    data, before = np.zeros((6, DATA), np.uint8), np.zeros((6, 2), np.uint8)
    for row, (last, bits) in enumerate(_EQUATIONS):
        data[row, np.array(bits) - 1] = 1
        before[row, last - 29] = 1
    return data, before


FROM_DATA, FROM_BEFORE = _matrices()


def parity(data: NDArray[np.uint8], before: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Parity bits (F, 6) of source data (F, 24) after the last bits of the words before (F, 2)."""
    return np.asarray((data @ FROM_DATA.T + before @ FROM_BEFORE.T) % 2, dtype=np.uint8)


def encode(bits: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Symbols (F, 300), +1 or -1, of subframes (F, 300) of source data.

    Parity bits, and the bits of words 2 and 10 that make their parity end in 00, are filled in.
    """
    sent = bits.copy()
    before = np.zeros((len(bits), 2), np.uint8)
    for word in range(WORDS):
        data = bits[:, word * WORD : word * WORD + DATA]
        if word in SOLVED:
            data[:, 22:] = 0
            data[:, 23] = parity(data, before)[:, 4]
            data[:, 22] = parity(data, before)[:, 5]
        check = parity(data, before)
        bits[:, word * WORD + DATA : (word + 1) * WORD] = check
        sent[:, word * WORD : word * WORD + DATA] = data ^ before[:, 1:]
        sent[:, word * WORD + DATA : (word + 1) * WORD] = check
        before = check[:, 4:]
    return (1 - 2 * sent.astype(np.int8)).astype(np.int8)


def failing(hard: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Which words of subframes (F, 300), as received with right sign, fail: (F, 10)."""
    words = hard.reshape(-1, WORDS, WORD)
    ends = words[:, :-1, 28:]
    before = np.concatenate([np.zeros((len(words), 1, 2), np.uint8), ends], axis=1)
    data = words[:, :, :DATA] ^ before[:, :, 1:]
    check = (data @ FROM_DATA.T + before @ FROM_BEFORE.T) % 2
    return np.asarray((check != words[:, :, DATA:]).any(axis=2))


def _patterns() -> dict[int, NDArray[np.float32]]:
    """Errors of up to two of the 30 bits of a word, by the parity failures that they cause."""
    sets = [c for size in (0, 1, 2) for c in combinations(range(WORD), size)]
    patterns = np.zeros((len(sets), WORD), np.float32)
    for row, places in zip(patterns, sets, strict=True):
        row[list(places)] = 1
    columns = np.concatenate([FROM_DATA, np.eye(6, dtype=np.uint8)], axis=1)
    failures = (patterns.astype(np.int64) @ columns.T) % 2 @ _BITS
    return {int(f): patterns[failures == f] for f in np.unique(failures)}


_BITS = 1 << np.arange(6)
PATTERNS = _patterns()


def decode(soft: NDArray[np.float32], noise: float) -> Decoded:
    """Most likely words of subframes (F, 300), signs resolved, with up to two errors a word.

    ``noise`` is the standard deviation of a symbol of amplitude 1.
    """
    count = len(soft)
    bits = (soft < 0).astype(np.uint8)
    corrected = np.zeros((count, WORDS), np.intp)
    doubtful = np.zeros((count, WORDS))
    before = np.zeros((count, 2), np.uint8)
    for word in range(WORDS):
        part = slice(word * WORD, (word + 1) * WORD)
        received = bits[:, part]
        data = received[:, :DATA] ^ before[:, 1:]
        failed = parity(data, before) ^ received[:, DATA:]
        errors, doubtful[:, word] = _most_likely(np.abs(soft[:, part]), failed, max(noise, 1e-3))
        corrected[:, word] = errors.sum(axis=1)
        received ^= errors
        before = received[:, 28:].copy()
        # The data, as they were before D30* of the last word inverted them.
        bits[:, word * WORD : word * WORD + DATA] = data ^ errors[:, :DATA]
    return Decoded(bits, corrected, doubtful)


def _most_likely(
    weight: NDArray[np.float32], failed: NDArray[np.uint8], noise: float
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Errors (F, 30) that explain parity failures at the least cost, and how doubtful they are."""
    errors = np.zeros(weight.shape, np.uint8)
    doubtful = np.ones(len(weight))
    kinds = failed @ _BITS
    for kind in np.unique(kinds).tolist():
        patterns = PATTERNS.get(kind)
        if patterns is None:
            continue
        rows = np.flatnonzero(kinds == kind)
        costs = (weight[rows] @ patterns.T).astype(np.float64)
        best = costs.argmin(axis=1)
        errors[rows] = patterns[best].astype(np.uint8)
        # Beyond the patterns: at least four errors where parity holds, three where it does not.
        doubtful[rows] = doubt(costs, weight[rows], 4 if kind == 0 else 3, noise)
    return errors, doubtful
