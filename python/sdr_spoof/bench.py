"""Speed of each stage on this machine, measured and reported as it is.

The workload is the demonstration's: real 8-bit samples at 120 Msps, five satellites with B1I and
B1C, made anew for each run of the benchmark. Rates count samples of the recording:

- synth: samples made; a channel is one signal component of one satellite, noise and front-end
  filter included;
- acquire: samples searched for B1I; a channel is one PRN over the whole search grid;
- correlate: samples tracked, loops included; a channel is one signal of one satellite.
"""

from __future__ import annotations

import os
import statistics
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from .acquisition import AcquisitionConfig, acquire
from .scenario import builtin_scenario, open_synthesizer, synthesize, transmissions
from .signals import signal_spec
from .sources import Recording, open_recording
from .tracking import TrackingConfig, track

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .progress import Progress
    from .records import Acquisition
    from .scenario import Scenario

_DURATION_S = 0.5
_SYNTH_S = 0.1
_PRNS = tuple(range(19, 43, 3))


@dataclass(frozen=True)
class Measurement:
    """Repeated timings of one stage, in million samples of the recording a second."""

    stage: str
    threads: int
    channels: int
    """Signals worked on at the same time."""
    samples: int
    """Samples of the recording in one run."""
    median_msps: float
    lowest_msps: float
    highest_msps: float
    per_channel_core_msps: float
    """Median, times channels, over threads."""


@dataclass(frozen=True)
class _Job:
    """One thing to time."""

    stage: str
    channels: int
    samples: int
    run: Callable[[int], object]
    """Takes the number of threads."""


def run(*, repeats: int = 5, progress: Progress | None = None) -> list[Measurement]:
    """Measure every stage with one thread and with one per core.

    Args:
        repeats: timed runs of each; one more, not timed, goes before them.
        progress: called with (measurements done, measurements in all).

    Raises:
        OutputError: no room for the workload (60 MB) in the temporary folder.
    """
    with tempfile.TemporaryDirectory(prefix="sdr-spoof-bench-") as folder:
        jobs = list(_jobs(_scenario(), Path(folder)))
        plan = [(job, threads) for job in jobs for threads in thread_counts()]
        results: list[Measurement] = []
        for job, threads in plan:
            results.append(_measure(job, threads, repeats))
            if progress is not None:
                progress(len(results), len(plan))
    return results


def thread_counts() -> list[int]:
    """One thread, and one per core that this process may use."""
    return sorted({1, len(os.sched_getaffinity(0))})


def _scenario() -> Scenario:
    """The clean demonstration scenario, cut short."""
    scenario = builtin_scenario("clean")
    plan = scenario.recording.model_copy(update={"duration_s": _DURATION_S})
    return scenario.model_copy(update={"recording": plan})


def _jobs(scenario: Scenario, folder: Path) -> Iterator[_Job]:
    recording = open_recording(synthesize(scenario, folder / "bench"))
    rate_hz = recording.format.sample_rate_hz
    yield _synth_job(scenario)
    config = AcquisitionConfig()
    searched = round(config.blocks_short * signal_spec("B1I").period_s * rate_hz)
    yield _Job(
        "acquire",
        len(_PRNS),
        searched,
        lambda threads: acquire(recording, config, signals=["B1I"], prns=_PRNS, threads=threads),
    )
    yield _track_job(recording, [a for a in acquire(recording, config) if a.detected])


def _synth_job(scenario: Scenario) -> _Job:
    count = round(_SYNTH_S * scenario.recording.sample_rate_hz)
    return _Job(
        "synth",
        len(transmissions(scenario)),
        count,
        lambda threads: open_synthesizer(scenario, threads).generate(0, count),
    )


def _track_job(recording: Recording, found: list[Acquisition]) -> _Job:
    config = TrackingConfig()
    return _Job(
        "correlate",
        len(found),
        recording.sample_count,
        lambda threads: track(recording, found, config, threads=threads),
    )


def _measure(job: _Job, threads: int, repeats: int) -> Measurement:
    """Time a job after one run that warms caches and plans."""
    job.run(threads)
    rates = [_rate_msps(job, threads) for _ in range(repeats)]
    median = statistics.median(rates)
    return Measurement(
        stage=job.stage,
        threads=threads,
        channels=job.channels,
        samples=job.samples,
        median_msps=median,
        lowest_msps=min(rates),
        highest_msps=max(rates),
        per_channel_core_msps=median * job.channels / threads,
    )


def _rate_msps(job: _Job, threads: int) -> float:
    start = time.perf_counter()
    job.run(threads)
    return job.samples / (time.perf_counter() - start) / 1e6
