"""Many runs of the receiver over many points, and what they add up to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.campaign.analysis import wilson
from sdr_spoof.reproduce import parallel

from .receiver import Point, Run, methods, run

if TYPE_CHECKING:
    from collections.abc import Sequence
    from concurrent.futures import Executor

    from sdr_spoof.progress import Progress
    from sdr_spoof.reproduce.study import Cell

SEED = 20_181_000


@dataclass(frozen=True)
class Result:
    """All runs at one point."""

    point: Point
    runs: tuple[Run, ...]

    @property
    def held(self) -> tuple[Run, ...]:
        """Runs in which both bands were tracked when the spoofer came: those that can be tested."""
        return tuple(r for r in self.runs if r.held)

    @property
    def lost(self) -> int:
        """Of those, runs in which joint tracking broke later."""
        return sum(bool(np.isfinite(r.lost_s)) for r in self.held)

    def detected(self, method: int) -> list[float]:
        """Latencies of the runs that one method detected, false alarms before not among them."""
        found = [r.latency_s[method] for r in self.held if not r.early[method]]
        return [latency for latency in found if np.isfinite(latency)]

    def alarmed(self, method: int) -> int:
        """Held runs in which one method alarmed at any time."""
        return sum(r.early[method] or bool(np.isfinite(r.latency_s[method])) for r in self.held)

    def tested(self, method: int) -> int:
        """Runs that one method could detect: held, and no false alarm before."""
        return sum(not r.early[method] for r in self.held)


def seed_of(point: Point, number: int) -> int:
    """Seed of one run at a point."""
    return parallel.seed_of(SEED, (point.cn0_dbhz, point.drag_hz, point.eta), number)


def measure(
    points: Sequence[Point],
    runs: int,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> list[Result]:
    """Run every point ``runs`` times; the results depend on neither executor nor order."""
    jobs = [(point, seed_of(point, k)) for point in points for k in range(runs)]
    done = parallel.repeat(run, jobs, executor, progress)
    return [Result(point, tuple(done[k * runs : (k + 1) * runs])) for k, point in enumerate(points)]


def columns() -> list[str]:
    """Columns of :func:`row`."""
    names = ["C/N0 (dB-Hz)", "drag f_e (Hz)", "eta", "runs", "held", "joint tracking broke"]
    names.append("median time to that (s)")
    for method in methods():
        names += [f"{what}{method.title}" for what in ("Pd, ", "low, ", "high, ", "median s, ")]
    return names


def details() -> list[str]:
    """Of these columns, the bounds of the intervals."""
    return [name for name in columns() if name.startswith(("low, ", "high, "))]


def row(result: Result) -> list[Cell]:
    """One point as a row: shares of the runs that were held, Wilson intervals, latencies."""
    held, point = len(result.held), result.point
    broke = [r.lost_s for r in result.held if np.isfinite(r.lost_s)]
    cells: list[Cell] = [point.cn0_dbhz, point.drag_hz, point.eta, len(result.runs), held]
    cells += [len(broke) / held if held else None, _median(broke)]
    for method in range(len(methods())):
        found, tested = result.detected(method), result.tested(method)
        low, high = wilson(len(found), tested)
        cells += [len(found) / tested if tested else None, float(low), float(high), _median(found)]
    return cells


def _median(values: Sequence[float]) -> float | None:
    return float(np.median(values)) if values else None
