"""Speed of each stage on this machine, measured and reported as it is.

The workload is the clean demonstration scenario: real 8-bit samples at 120 Msps, five satellites
with B1I and B1C at 45 dB-Hz. Rates count samples of the recording; planning, files and the making
of input are not timed:

- synth: samples made; a channel is one signal component of one satellite, noise and front-end
  filter included;
- acquire: samples searched for B1I on the default grid; a channel is one PRN;
- correlate: samples tracked, front ends and loops included; a channel is one signal of one
  satellite. Timing starts once every channel knows its symbols or secondary code, so that all of
  them run as they do in the long run.
"""

from __future__ import annotations

import os
import platform
import statistics
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from . import _core
from .acquisition import AcquisitionConfig, acquire
from .errors import SdrSpoofError
from .records import State
from .scenario import builtin_scenario, open_synthesizer, synthesize, transmissions
from .scenario.live import LiveRecording
from .signals import signal_spec
from .sources import open_recording
from .tracking import TrackingConfig

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .progress import Progress
    from .records import Acquisition
    from .scenario import Scenario

_FILE_S = 0.1
"""Recording for the search: six code periods of B1C and some."""
_BLOCK_S = 0.1
"""Samples made, or tracked, in one timed run."""
_SETTLE_S = 5.0
"""All channels must be synchronised after this."""
_PRNS = tuple(range(19, 43, 3))


@dataclass(frozen=True)
class Machine:
    """What was measured on; a load beside the benchmark's own makes it slower."""

    processor: str
    cores: int
    """That this process may use."""
    load_average: float
    """Of the last minute, when the benchmark began."""


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
    times_real_time: float
    """Median over the recording's sample rate, all channels together."""


@dataclass(frozen=True)
class _Job:
    """One thing to time."""

    stage: str
    channels: int
    samples: int
    runs: Callable[[int], Iterator[Callable[[], object]]]
    """For a number of threads: the runs, one after the other; what is done to get the next one
    is not timed."""


def run(*, repeats: int = 5, progress: Progress | None = None) -> list[Measurement]:
    """Measure every stage with one thread and with one per core.

    Args:
        repeats: timed runs of each; one more, not timed, goes before them.
        progress: called with (measurements done, measurements in all).

    Raises:
        OutputError: no room for the workload (12 MB) in the temporary folder.
        SdrSpoofError: a channel does not track.
    """
    with tempfile.TemporaryDirectory(prefix="sdr-spoof-bench-") as folder:
        jobs = list(_jobs(repeats, Path(folder)))
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


def machine() -> Machine:
    """The machine, and how busy it is."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    name = names[0] if names else platform.processor() or platform.machine()
    return Machine(name, thread_counts()[-1], round(os.getloadavg()[0], 2))


def _scenario(duration_s: float) -> Scenario:
    """The clean demonstration scenario, of another length."""
    scenario = builtin_scenario("clean")
    plan = scenario.recording.model_copy(update={"duration_s": duration_s})
    return scenario.model_copy(update={"recording": plan})


def _jobs(repeats: int, folder: Path) -> Iterator[_Job]:
    scenario = _scenario(_SETTLE_S + (repeats + 2) * _BLOCK_S)
    rate_hz = scenario.recording.sample_rate_hz
    recording = open_recording(synthesize(_scenario(_FILE_S), folder / "bench"))
    config = AcquisitionConfig()
    found = [a for a in acquire(recording, config) if a.detected]
    block = round(_BLOCK_S * rate_hz)
    searched = round(config.blocks_short * signal_spec("B1I").period_s * rate_hz)

    def search(threads: int) -> Iterator[Callable[[], object]]:
        while True:
            yield lambda: acquire(recording, config, signals=["B1I"], prns=_PRNS, threads=threads)

    yield _Job("synth", len(transmissions(scenario)), block, lambda n: _made(scenario, n))
    yield _Job("acquire", len(_PRNS), searched, search)
    yield _Job("correlate", len(found), block, lambda n: _tracked(scenario, found, n))


def _made(scenario: Scenario, threads: int) -> Iterator[Callable[[], object]]:
    """Runs of synthesis, block after block."""
    synthesizer = open_synthesizer(scenario, threads)
    block = round(_BLOCK_S * scenario.recording.sample_rate_hz)
    for start in range(0, scenario.recording.sample_count, block):
        yield lambda start=start: synthesizer.generate(start, block)  # type: ignore[misc]


def _tracked(
    scenario: Scenario, found: list[Acquisition], threads: int
) -> Iterator[Callable[[], object]]:
    """Runs of tracking, block after block, from where every channel is synchronised."""
    recording = LiveRecording(scenario)
    tracker = _tracker(recording, found, threads)
    block = round(_BLOCK_S * recording.format.sample_rate_hz)
    for start in range(0, recording.sample_count, block):
        raw = recording.read_raw(start, block)
        if _synchronised(tracker):
            yield lambda raw=raw: tracker.feed(raw)  # type: ignore[misc]
        elif start < _SETTLE_S * recording.format.sample_rate_hz:
            tracker.feed(raw)
        else:
            break
    raise SdrSpoofError("the benchmark's satellites are not tracked; correlation is not measured")


def _tracker(recording: LiveRecording, found: list[Acquisition], threads: int) -> _core.Tracker:
    form = recording.format
    return _core.Tracker(
        form.sample_format,
        form.sample_rate_hz,
        form.lo_hz,
        TrackingConfig(qmboc=True).model_dump(exclude={"reacquire"}),
        [(a.signal, a.prn, a.sample_index, a.doppler_hz, a.code_delay_s) for a in found],
        threads=threads,
    )


def _synchronised(tracker: _core.Tracker) -> bool:
    states = [rows["state"] for rows in tracker.take_signals()]
    return all(len(s) > 0 and s[-1] >= State.SYNCED for s in states)


def _measure(job: _Job, threads: int, repeats: int) -> Measurement:
    """Time a job after one run that warms caches."""
    runs = job.runs(threads)
    next(runs)()
    rates = [job.samples / _seconds(next(runs)) / 1e6 for _ in range(repeats)]
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
        times_real_time=median * 1e6 / _scenario(_FILE_S).recording.sample_rate_hz,
    )


def _seconds(action: Callable[[], object]) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start
