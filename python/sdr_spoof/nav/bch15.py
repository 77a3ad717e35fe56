"""BCH(15,11) and the words of D1 and D2 that are made of it.

Source: BDS-SIS-ICD-B1I-3.0, 5.1.3: generator x^4 + x + 1, one error corrected; word 1 of a subframe
has 15 bits that are not coded and one block, words 2 to 10 have two blocks, interleaved bit by bit.

The code is perfect: whatever is received is at most one bit from a codeword, so that hard decisions
never tell that they are wrong. Here the codeword of largest correlation is taken (maximum
likelihood) among those up to three errors away, and the probability that it is wrong is told.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from .soft import Decoded, doubt

if TYPE_CHECKING:
    from numpy.typing import NDArray

GENERATOR = 0b10011
LENGTH, INFORMATION = 15, 11
SUBFRAME = 300


def _parity(words: NDArray[np.int64]) -> NDArray[np.int64]:
    """Parity of 11 information bits each: the remainder of word x^4 by the generator."""
    rest = words << (LENGTH - INFORMATION)
    for degree in range(LENGTH - 1, LENGTH - INFORMATION - 1, -1):
        rest = rest ^ (rest >> degree & 1) * (GENERATOR << (degree - (LENGTH - INFORMATION)))
    return rest


def _codewords() -> NDArray[np.uint8]:
    words = np.arange(1 << INFORMATION)
    coded = words << (LENGTH - INFORMATION) | _parity(words)
    return (coded[:, None] >> np.arange(LENGTH - 1, -1, -1) & 1).astype(np.uint8)


CODEWORDS = _codewords()
"""All 2048, by their information bits."""
_WEIGHTS = 1 << np.arange(INFORMATION - 1, -1, -1)


def _blocks() -> NDArray[np.intp]:
    """Where the 19 blocks of a subframe lie in its symbols as they are sent, (19, 15)."""
    first = [np.arange(15, 30)]
    others = [np.arange(30 * w + b, 30 * w + 30, 2) for w in range(1, 10) for b in (0, 1)]
    return np.array(first + others)


def _places() -> NDArray[np.intp]:
    """Where their bits lie in the subframe as the ICD numbers it, (19, 15)."""
    first = [np.arange(15, 30)]
    for word in range(1, 10):
        for block in (0, 1):
            start = 30 * word
            information = start + INFORMATION * block + np.arange(INFORMATION)
            parity = start + 22 + 4 * block + np.arange(4)
            first.append(np.concatenate([information, parity]))
    return np.array(first)


SENT = _blocks()
PLACES = _places()


def encode(bits: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Symbols (F, 300), +1 or -1, of subframes (F, 300) in the ICD's order.

    The parity bits of ``bits`` are filled in.
    """
    words = bits[:, PLACES[:, :INFORMATION]].astype(np.int64) @ _WEIGHTS
    bits[:, PLACES] = CODEWORDS[words]
    sent = bits.copy()
    sent[:, SENT] = bits[:, PLACES]
    return (1 - 2 * sent.astype(np.int8)).astype(np.int8)


def wrong_blocks(hard: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Which of the 19 blocks of subframes (F, 300), as sent, are no codewords: (F, 19)."""
    blocks = hard[:, SENT]
    parity = CODEWORDS[blocks[:, :, :INFORMATION].astype(np.int64) @ _WEIGHTS]
    return np.asarray((parity != blocks).any(axis=2))


def decode(soft: NDArray[np.float32], noise: float) -> Decoded:
    """Most likely codewords of subframes (F, 300) as sent, signs resolved.

    ``noise`` is the standard deviation of a symbol of amplitude 1.
    """
    blocks = soft[:, SENT].reshape(-1, LENGTH)
    hard = (blocks < 0).astype(np.uint8)
    errors, doubtful = _most_likely(np.abs(blocks), _syndromes(hard), max(noise, 1e-3))
    shape = (len(soft), len(SENT))
    bits = (soft < 0).astype(np.uint8)
    bits[:, PLACES] = (hard ^ errors).reshape(*shape, LENGTH)
    return Decoded(bits, errors.sum(axis=1).reshape(shape), doubtful.reshape(shape))


def _syndromes(blocks: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Received parity against that of the received information, (N, 15) to (N,)."""
    parity = CODEWORDS[blocks[:, :INFORMATION].astype(np.int64) @ _WEIGHTS, INFORMATION:]
    return np.asarray((parity ^ blocks[:, INFORMATION:]) @ (1 << np.arange(4)))


def _patterns() -> list[NDArray[np.uint8]]:
    """Errors of up to three bits, by the syndrome that they cause; the fewest first."""
    sets = [c for size in range(MOST_ERRORS + 1) for c in combinations(range(LENGTH), size)]
    patterns = np.zeros((len(sets), LENGTH), np.uint8)
    for row, places in zip(patterns, sets, strict=True):
        row[list(places)] = 1
    syndromes = _syndromes(patterns)
    return [patterns[syndromes == s] for s in range(16)]


MOST_ERRORS = 3
PATTERNS = _patterns()


def _most_likely(
    weight: NDArray[np.float32], syndromes: NDArray[np.int64], noise: float
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Errors (N, 15) that explain syndromes at the least cost, and how doubtful they are."""
    errors = np.zeros(weight.shape, dtype=np.uint8)
    doubtful = np.zeros(len(weight))
    for syndrome, patterns in enumerate(PATTERNS):
        rows = np.flatnonzero(syndromes == syndrome)
        costs = (weight[rows] @ patterns.T).astype(np.float64)
        best = costs.argmin(axis=1)
        errors[rows] = patterns[best]
        doubtful[rows] = doubt(costs, weight[rows], MOST_ERRORS + 1, noise)
    return errors, doubtful
