"""Frame error rate of B-CNAV1 against C/N0.

Frames of random bits are coded, sent with unit amplitude through white Gaussian noise, and decoded
as the receiver does it: amplitude and noise are estimated from the symbols of the frame. With T =
10 ms a symbol, Es/N0 = (C/N0) T, of which C is the power of the *data component*, a quarter of the
whole signal's.

What is compared with:

- The normal approximation of the error rate that the best code of the same length and rate can
  have on the same channel: Q(sqrt(n / V) (C - R + log2(n) / (2 n))) with the capacity C and the
  dispersion V of the binary-input Gaussian channel (Polyanskiy, Poor and Verdu 2010, equations 282
  and 296).
- Pocket SDR's decoder on frames of the same kind, see :data:`PEER`.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from sdr_spoof import _core
from sdr_spoof.reproduce.parallel import repeat, seed_of, workers
from sdr_spoof.signals import signal_spec

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.progress import Progress

ES_N0_DB = tuple(np.arange(-3.0, -0.4, 0.25).tolist())
SYMBOL_S, SYMBOLS, FIRST = 0.01, 1800, 72
LENGTHS = {"subframe 2": (1200, 600), "subframe 3": (528, 264)}
"""Symbols and bits."""
PRN = 27
CHUNK = 25
"""Frames of one seed."""
STUDY = 51
GOAL = 1e-2


@dataclass(frozen=True)
class Point:
    """Frames at one C/N0."""

    es_n0_db: float
    data_cn0_dbhz: float
    """C/N0 of the data component."""
    signal_cn0_dbhz: float
    """C/N0 of the whole signal, pilot included."""
    frames: int
    subframe2_rate: float
    """Share of frames whose subframe 2 was not decoded, or not as it was sent."""
    subframe3_rate: float
    first_rate: float
    """Share of frames whose subframe 1 names another satellite or frame."""
    start_rate: float
    """Share of frames whose start, unknown, was not found from one subframe 1 alone."""
    undetected: int
    """Subframes that passed their check and were wrong."""
    iterations2: float
    iterations3: float


@dataclass(frozen=True)
class Peer:
    """Pocket SDR's error rates."""

    es_n0_db: float
    frames: int
    subframe2_rate: float
    subframe3_rate: float


PEER: tuple[Peer, ...] = ()
"""Measured on 2026-11-22 with ``sdr_decode_NB_LDPC`` of Pocket SDR (commit b6af31f, truncated
extended min-sum, 15 iterations) on frames of this kind, symbols scaled to 32 steps of amplitude,
the best of three scales."""


def run(
    output: Path,
    *,
    frames: int = 2000,
    threads: int | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Measure every point; write bcnav1.{json,csv,png}.

    Args:
        output: folder to write to.
        frames: at each point.
        threads: worker processes; the numbers do not depend on it.
        progress: called with (done, total).

    Returns:
        What bcnav1.json holds.
    """
    points = measure(ES_N0_DB, frames, threads=threads or 1, progress=progress)
    table = [asdict(p) for p in points]
    result = {"frames": frames, "points": table, "thresholds": thresholds(points)}
    output.mkdir(parents=True, exist_ok=True)
    (output / "bcnav1.json").write_text(json.dumps(result, indent=1) + "\n")
    with (output / "bcnav1.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    from .bcnav1_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    draw(output / "bcnav1.png", points)
    return result


def measure(
    es_n0_db: Sequence[float],
    frames: int,
    *,
    threads: int = 1,
    progress: Progress | None = None,
) -> list[Point]:
    """Error rates at each ratio of symbol energy to noise density."""
    chunks = -(-frames // CHUNK)
    jobs = [(ratio, seed_of(STUDY, [ratio + 20], k)) for ratio in es_n0_db for k in range(chunks)]
    with workers(threads) as executor:
        counts = repeat(count, jobs, executor, progress)
    share = 10 * np.log10(signal_spec("B1CD").power_share)
    points = []
    for n, ratio in enumerate(es_n0_db):
        sums = np.sum(counts[n * chunks : (n + 1) * chunks], axis=0)
        rates = sums[:-1] / (chunks * CHUNK)
        data = ratio - 10 * np.log10(SYMBOL_S)
        points.append(
            Point(
                es_n0_db=ratio,
                data_cn0_dbhz=float(data),
                signal_cn0_dbhz=float(data - share),
                frames=chunks * CHUNK,
                subframe2_rate=float(rates[0]),
                subframe3_rate=float(rates[1]),
                first_rate=float(rates[2]),
                start_rate=float(rates[3]),
                iterations2=float(rates[4]),
                iterations3=float(rates[5]),
                undetected=int(sums[-1]),
            )
        )
    return points


def count(es_n0_db: float, seed: int) -> NDArray[np.int64]:
    """Of some frames: errors of subframe 2, of subframe 3, of subframe 1, of the start; passes of
    the decoder for subframes 2 and 3; undetected errors."""
    random = np.random.default_rng(seed)
    sigma = np.sqrt(0.5 / 10 ** (es_n0_db / 10))
    sums = np.zeros(7, dtype=np.int64)
    for _ in range(CHUNK):
        data = [random.integers(0, 2, size).astype(np.uint8) for size in (576, 240)]
        soh, cut = (int(v) for v in random.integers(0, (200, SYMBOLS - FIRST + 1)))
        frame = _core.cnav1_encode(PRN, soh, *data)
        values = (frame + sigma * random.standard_normal(SYMBOLS)).astype(np.float32)
        decoded = _core.cnav1_decode(values[None])[0]
        right2 = np.array_equal(decoded.bits2[:576], data[0])
        right3 = np.array_equal(decoded.bits3[:240], data[1])
        # Behind the end of the frame itself, as if the one before it were the same.
        moved = np.concatenate([values[SYMBOLS - cut :], values])[:SYMBOLS]
        start = _core.cnav1_find(moved, PRN, 1)[0]
        sums += [
            not (decoded.ok2 and right2),
            not (decoded.ok3 and right3),
            (decoded.prn, decoded.soh) != (PRN, soh),
            start[:3] != (cut, False, soh),
            decoded.iterations2,
            decoded.iterations3,
            (decoded.ok2 and not right2) + (decoded.ok3 and not right3),
        ]
    return sums


def thresholds(points: Sequence[Point]) -> list[dict[str, Any]]:
    """C/N0 of the data component, and of the whole signal, at which one frame in a hundred fails,
    beside the peer's and the best possible."""
    rows = []
    for name, field in (("subframe 2", "subframe2_rate"), ("subframe 3", "subframe3_rate")):
        ours = crossing([p.es_n0_db for p in points], [getattr(p, field) for p in points])
        peer = crossing([p.es_n0_db for p in PEER], [getattr(p, field) for p in PEER])
        grid = np.arange(-4.0, 0.0, 0.05)
        best = crossing(grid, [best_rate(float(x), *LENGTHS[name]) for x in grid])
        offset = -10 * np.log10(SYMBOL_S)
        share = 10 * np.log10(signal_spec("B1CD").power_share)
        rows.append(
            {
                "part": name,
                "error_rate": GOAL,
                "data_cn0_dbhz": ours + offset,
                "signal_cn0_dbhz": ours + offset - share,
                "peer_data_cn0_dbhz": peer + offset,
                "best_possible_data_cn0_dbhz": best + offset,
            }
        )
    return rows


def crossing(x: Sequence[float] | NDArray[np.float64], rates: Sequence[float]) -> float:
    """Where a falling error rate passes the goal, straight lines between logarithms; NaN if not."""
    for n in range(1, len(rates)):
        if rates[n - 1] >= GOAL > rates[n] > 0:
            a, b, goal = np.log([rates[n - 1], rates[n], GOAL])
            return float(x[n - 1] + (x[n] - x[n - 1]) * (goal - a) / (b - a))
    return float("nan")


@cache
def best_rate(es_n0_db: float, length: int, bits: int) -> float:
    """Error rate of the best code, by the normal approximation."""
    sigma = np.sqrt(0.5 / 10 ** (es_n0_db / 10))
    points, weights = _quadrature()
    density = 1 - np.logaddexp(0, -2 * (1 + sigma * points) / sigma**2) / np.log(2)
    capacity = float(weights @ density)
    dispersion = float(weights @ (density - capacity) ** 2)
    margin = capacity - bits / length + np.log2(length) / (2 * length)
    return float(norm.sf(np.sqrt(length / dispersion) * margin))


@cache
def _quadrature() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and weights of a mean over the standard normal law."""
    points, weights = np.polynomial.hermite_e.hermegauss(80)
    return points, weights / weights.sum()
