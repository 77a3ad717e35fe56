"""Speed of each stage on this machine, measured and reported as it is."""

from __future__ import annotations

import os
import statistics
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from .progress import Progress


@dataclass(frozen=True)
class Measurement:
    """Repeated timings of one stage, in million input samples a second (all channels)."""

    stage: str
    threads: int
    channels: int
    samples: int
    """Samples of the recording in one run."""
    median_msps: float
    lowest_msps: float
    highest_msps: float

    @property
    def per_channel_core_msps(self) -> float:
        """Median times channels, per thread."""
        return self.median_msps * self.channels / self.threads


def measure(
    stage: str, run_once: Callable[[], object], samples: int, threads: int, channels: int, *, n: int
) -> Measurement:
    """Time ``run_once`` n times after one warm-up run."""
    run_once()
    rates = []
    for _ in range(n):
        start = time.perf_counter()
        run_once()
        rates.append(samples / (time.perf_counter() - start) / 1e6)
    return Measurement(
        stage, threads, channels, samples, statistics.median(rates), min(rates), max(rates)
    )


def thread_counts() -> list[int]:
    """One thread, and one per core."""
    return sorted({1, os.cpu_count() or 1})


def run(*, repeats: int = 5, progress: Progress | None = None) -> list[Measurement]:
    """Measure every stage at every thread count."""
    raise NotImplementedError
