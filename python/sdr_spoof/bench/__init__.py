"""Speed of each stage on this machine, measured and reported as it is.

Stages (``workloads.py`` says what W1 and W2 are):

- receiver: what ``sdr-spoof track`` does once it has acquired. Samples are read from a file (in
  the page cache), tracked with all loops and judgements, and the result file is written. Whole
  files are timed, pull-in included; every signal is synchronised at their end.
- engine: the correlator engine alone, on noise, every channel under way before timing begins.
- channel: what one B1I channel more costs the engine (slope over 12, 24 and 36 channels).
- acquisition: the search of a recording for all PRNs, samples read from its file.
- synthesis: samples made to memory; a channel is one emitter.
"""

from __future__ import annotations

import statistics
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof.progress import silent

from .machine import Machine, load_average, machine
from .plan import Settings, jobs
from .worker import measure
from .workloads import RATES, recording

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.progress import Stages

    from .jobs import Job
    from .worker import Timing

__all__ = ["Machine", "Measurement", "Settings", "load_average", "machine", "run"]

_READING = ("receiver", "acquisition")
"""Stages that need a recording."""


@dataclass(frozen=True)
class Measurement:
    """Repeated timings of one job."""

    stage: str
    workload: str
    sample_rate_hz: float
    level: str
    """Vector instructions."""
    threads: int
    channels: int
    """Signals, PRNs or emitters worked on at the same time; 1 for the cost of one more."""
    signal_s: float
    """Signal in one run; of acquisition, in the recording."""
    lowest_s: float
    """Shortest run."""
    median_s: float
    highest_s: float
    times_real_time: float
    """Signal over median."""
    channels_per_core: float
    """That one core could do in real time: times real time, times channels, over threads."""
    us_per_ms_channel: float
    """Core time for a millisecond of one channel, its share of the front end included."""
    peak_memory_mb: float
    """Of the process that ran this job alone."""


def run(settings: Settings, *, stages: Stages = silent) -> list[Measurement]:
    """Measure.

    Args:
        settings: what.
        stages: opens progress displays.

    Raises:
        OutputError: no room for the recordings.
        SdrSpoofError: a job failed.
    """
    with tempfile.TemporaryDirectory(prefix="sdr-spoof-bench-") as temporary:
        folder = settings.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        planned = list(jobs(settings))
        paths = _recordings(planned, folder, stages)
        results: list[Measurement] = []
        with stages("Measuring") as progress:
            for job in planned:
                path = paths.get((job.msps, job.signal_s), "")
                timing = measure(replace(job, recording=path), settings.repeats)
                results.append(_measurement(job, timing))
                if progress is not None:
                    progress(len(results), len(planned))
    return results


def _recordings(
    planned: Sequence[Job], folder: Path, stages: Stages
) -> dict[tuple[int, float], str]:
    """Paths of the recordings that jobs read, by rate and length; made where they are missing."""
    needed = {(j.msps, j.signal_s) for j in planned if j.stage in _READING}
    paths = {}
    for msps, duration_s in sorted(needed):
        with stages(f"Making {duration_s:g} s at {msps} Msps") as progress:
            made = recording(RATES[msps], duration_s, folder, progress)
        paths[msps, duration_s] = str(made.path)
    return paths


def _measurement(job: Job, timing: Timing) -> Measurement:
    median = statistics.median(timing.seconds)
    times = job.signal_s / median
    # The cost of one more channel is a single channel's already.
    channels = 1 if job.stage == "channel" else job.channels
    return Measurement(
        stage=job.stage,
        workload=job.workload,
        sample_rate_hz=job.rate.sample_rate_hz,
        level=job.level,
        threads=job.threads,
        channels=channels,
        signal_s=job.signal_s,
        lowest_s=min(timing.seconds),
        median_s=median,
        highest_s=max(timing.seconds),
        times_real_time=times,
        channels_per_core=times * channels / job.threads,
        us_per_ms_channel=1e3 * job.threads / (times * channels),
        peak_memory_mb=timing.peak_mb,
    )
