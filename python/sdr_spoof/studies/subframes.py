"""Subframes of LNAV, D1 and D2 that are found, taken, and wrong, against C/N0.

Runs of subframes of random bits, with right times and numbers, through white Gaussian noise; the
decoder knows neither their start nor their sign. Beside them, what hard decisions would make of the
same symbols: D1 and D2 a wrong subframe where a block has two errors or more, which the code cannot
notice; LNAV a lost one where the parity of any word fails.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.nav import bch15
from sdr_spoof.nav.bits import PAGE_BITS
from sdr_spoof.nav.d1 import D1Message
from sdr_spoof.nav.d2 import D2Message
from sdr_spoof.nav.lnav import LnavMessage
from sdr_spoof.nav.records import SymbolRun
from sdr_spoof.nav.time import WEEK_S
from sdr_spoof.reproduce.parallel import repeat, seed_of, workers

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.nav.subframes import SubframeMessage
    from sdr_spoof.progress import Progress

MESSAGES: tuple[SubframeMessage, ...] = (D1Message(), D2Message(), LnavMessage())
SIGNALS = {"D1": ("B1I", 27), "D2": ("B1I", 3), "LNAV": ("L1CA", 12)}
ES_N0_DB = (3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 11.0)
"""Of a symbol; C/N0 is more by 17 dB at 50 and by 27 dB at 500 symbols a second."""
CHUNK = 120
"""Subframes of one run; the last, whose closing preamble is not there, is not counted."""
STUDY = 52


@dataclass(frozen=True)
class Point:
    """Subframes of a message at one C/N0."""

    message: str
    cn0_dbhz: float
    subframes: int
    found_rate: float
    """Share whose time was told."""
    taken_rate: float
    """Share whose bits were taken for right."""
    wrong: int
    """Subframes taken with a wrong bit, or found with a wrong time."""
    hard_rate: float
    """Share that hard decisions lose, or, in D1 and D2, get wrong."""


def run(
    output: Path,
    *,
    subframes: int = 12_000,
    threads: int | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Measure every point; write subframes.json.

    Args:
        output: folder to write to.
        subframes: of each message at each C/N0.
        threads: worker processes; the numbers do not depend on it.
        progress: called with (done, total).

    Returns:
        What subframes.json holds.
    """
    points = measure(ES_N0_DB, subframes, threads=threads or 1, progress=progress)
    result = {"points": [asdict(p) for p in points]}
    output.mkdir(parents=True, exist_ok=True)
    (output / "subframes.json").write_text(json.dumps(result, indent=1) + "\n")
    return result


def measure(
    es_n0_db: Sequence[float],
    subframes: int,
    *,
    threads: int = 1,
    progress: Progress | None = None,
) -> list[Point]:
    """All messages at each ratio of symbol energy to noise density."""
    chunks = -(-subframes // CHUNK)
    cases = [(which, ratio) for which in range(len(MESSAGES)) for ratio in es_n0_db]
    jobs = [(case, seed_of(STUDY, case, k)) for case in cases for k in range(chunks)]
    with workers(threads) as executor:
        counts = repeat(count, jobs, executor, progress)
    points = []
    for n, (which, ratio) in enumerate(cases):
        found, taken, wrong, hard = np.sum(counts[n * chunks : (n + 1) * chunks], axis=0)
        total = chunks * (CHUNK - 1)
        message = MESSAGES[which]
        points.append(
            Point(
                message=message.name,
                cn0_dbhz=round(float(ratio - 10 * np.log10(message.symbol_s)), 2),
                subframes=total,
                found_rate=float(found / total),
                taken_rate=float(taken / total),
                wrong=int(wrong),
                hard_rate=float(hard / total),
            )
        )
    return points


def count(case: tuple[int, float], seed: int) -> NDArray[np.int64]:
    """Of a run: subframes found, taken, wrong, and lost or wrong by hard decisions."""
    message = MESSAGES[case[0]]
    random = np.random.default_rng(seed)
    first = int(random.integers(0, round(WEEK_S / message.subframe_s) - CHUNK))
    bits = random.integers(0, 2, (CHUNK, PAGE_BITS)).astype(np.uint8)
    for k, row in enumerate(bits):
        row[: message.preamble.size] = message.preamble
        message.head(row, first + k)
    symbols = message.to_symbols(bits)
    sigma = np.sqrt(0.5 / 10 ** (case[1] / 10))
    values = symbols + sigma * random.standard_normal(symbols.shape)
    hard = _hard(message, (values < 0) != (symbols < 0))[:-1]
    found = taken = wrong = 0
    sign = 1 - 2 * int(random.integers(2))
    for frame in message.decode(_run(message, sign * values.reshape(-1))):
        k, rest = divmod(round(frame.code_phase_chips), PAGE_BITS)
        second, later = message.begins(first + k)
        tow = frame.transmitted.week_tow(message.system)[1]
        right = rest == 0 and abs(tow - second - later) < 1e-6
        # What goes before the words of D1 and D2 is not coded.
        same = (frame.bits[15:] == bits[k, 15:]).all()
        wrong += not right or (frame.ok and not same)
        found += k < CHUNK - 1
        taken += frame.ok and k < CHUNK - 1
    return np.array([found, taken, wrong, np.count_nonzero(hard)])


def _run(message: SubframeMessage, values: NDArray[np.float64]) -> SymbolRun:
    signal, prn = SIGNALS[message.name]
    k = np.arange(values.size, dtype=np.float64)
    soft = values.astype(np.float32)
    return SymbolRun(signal, prn, k, k * message.symbol_s, soft, message.symbol_s)


def _hard(message: SubframeMessage, errors: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which subframes hard decisions lose or get wrong."""
    if isinstance(message, LnavMessage):
        return np.asarray(errors.any(axis=1))
    return np.asarray((errors[:, bch15.SENT].sum(axis=2) > 1).any(axis=1))
