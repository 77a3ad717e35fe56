"""Subframe error rate of D1, D2 and LNAV against C/N0.

Subframes of random bits are coded, sent with unit amplitude through white Gaussian noise of known
strength and decoded by most likely words, as the receiver does. A subframe is *lost* where a word
is wrong or too doubtful to be taken, *undetected* where it is taken although a word is wrong.
Beside it what decisions by sign alone give: one error repaired in each BCH code word (D1, D2), none
(LNAV, whose parity then only detects). With T a symbol, Es/N0 = (C/N0) T; D2 is D1 ten times as
fast and needs 10 dB more C/N0.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.nav import bch15, lnav_words
from sdr_spoof.nav.bits import PAGE_BITS
from sdr_spoof.nav.subframes import TRUSTED
from sdr_spoof.reproduce.parallel import seed_of

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.progress import Progress

    Bits = NDArray[np.uint8]

ES_N0_DB = tuple(np.arange(1.0, 9.1, 0.5).tolist())
SYMBOL_S = {"D1": 0.02, "D2": 0.002, "LNAV": 0.02}
CODES = ("D1", "LNAV")
"""Those measured; D2 has D1's code."""
CHUNK = 200
STUDY = 52
FIRST_WORD = 30


@dataclass(frozen=True)
class Point:
    """Subframes of one code at one ratio of symbol energy to noise density."""

    code: str
    es_n0_db: float
    cn0_dbhz: float
    """At 20 ms a symbol."""
    subframes: int
    lost_rate: float
    wrong_rate: float
    """Share with a wrong word, whether taken or not."""
    undetected: int
    hard_rate: float
    """Share lost by decisions by sign alone."""


def run(
    output: Path, *, subframes: int = 20_000, progress: Progress | None = None
) -> dict[str, Any]:
    """Measure every point; write subframes.{json,csv,png}.

    Args:
        output: folder to write to.
        subframes: at each point.
        progress: called with (done, total).

    Returns:
        What subframes.json holds.
    """
    points = []
    for code in CODES:
        for n, ratio in enumerate(ES_N0_DB):
            points.append(measure(code, ratio, subframes))
            if progress:
                progress(CODES.index(code) * len(ES_N0_DB) + n + 1, len(CODES) * len(ES_N0_DB))
    table = [asdict(p) for p in points]
    result = {"subframes": subframes, "points": table}
    output.mkdir(parents=True, exist_ok=True)
    (output / "subframes.json").write_text(json.dumps(result, indent=1) + "\n")
    with (output / "subframes.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    from .subframes_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    draw(output / "subframes.png", points)
    return result


def measure(code: str, es_n0_db: float, subframes: int) -> Point:
    """Error rates of one point."""
    chunks = -(-subframes // CHUNK)
    cn0_dbhz = es_n0_db - 10 * np.log10(SYMBOL_S[code])
    case = [CODES.index(code), cn0_dbhz]
    counts = sum(_count(code, es_n0_db, seed_of(STUDY, case, k)) for k in range(chunks))
    lost, wrong, undetected, hard = (int(c) for c in np.asarray(counts))
    total = chunks * CHUNK
    return Point(
        code=code,
        es_n0_db=es_n0_db,
        cn0_dbhz=float(cn0_dbhz),
        subframes=total,
        lost_rate=lost / total,
        wrong_rate=wrong / total,
        undetected=undetected,
        hard_rate=hard / total,
    )


def _count(code: str, es_n0_db: float, seed: int) -> NDArray[np.int64]:
    """Subframes lost, wrong, undetected, and lost by hard decisions."""
    random = np.random.default_rng(seed)
    sigma = float(np.sqrt(0.5 / 10 ** (es_n0_db / 10)))
    bits = random.integers(0, 2, (CHUNK, PAGE_BITS)).astype(np.uint8)
    module = bch15 if code == "D1" else lnav_words
    symbols = module.encode(bits)
    soft = (symbols + sigma * random.standard_normal(symbols.shape)).astype(np.float32)
    decoded = module.decode(soft, sigma)
    differs = decoded.bits != bits
    if code == "D1":
        differs[:, :15] = False  # not coded, and known: preamble
    wrong = differs.any(axis=1)
    refused = decoded.doubt.sum(axis=1) >= TRUSTED
    hard = (_hard_d1 if code == "D1" else _hard_lnav)(soft, bits)
    return np.array([(wrong | refused).sum(), wrong.sum(), (wrong & ~refused).sum(), hard.sum()])


def _hard_d1(soft: NDArray[np.float32], bits: Bits) -> NDArray[np.bool_]:
    """Wrong after the repair of one error in each code word; the first word left out."""
    wrong = bch15.correct((soft < 0).astype(np.uint8)) != bits
    return np.asarray(wrong[:, FIRST_WORD:].any(axis=1))


def _hard_lnav(soft: NDArray[np.float32], bits: Bits) -> NDArray[np.bool_]:
    """Parity of any word fails. Words that pass with errors are too few to count here."""
    del bits
    return np.asarray(lnav_words.failing((soft < 0).astype(np.uint8)).any(axis=1))
