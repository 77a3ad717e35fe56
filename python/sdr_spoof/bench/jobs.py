"""What the benchmark times: for each stage a function that gets everything ready for a job.

Each returns an action that does the work once and gives the seconds that it took.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import SdrSpoofError
from sdr_spoof.records import State
from sdr_spoof.scenario import open_synthesizer
from sdr_spoof.sources import open_recording

from .workloads import RATES, Channel, Rate, b1i, channels, scenario, shared_out, taps, tracked

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Action = Callable[[], float]

_FED_S = 0.02
"""Samples that an engine gets again and again: as short as the blocks that a receiver feeds."""
SEARCHES = {"B1I": ["B1I"], "B1C": ["B1CP"], "B1I, B1C handed over": ["B1I", "B1CP"]}
"""Signals of each acquisition workload; a single one is searched blind."""


@dataclass(frozen=True)
class Job:
    """One thing to time."""

    stage: str
    """A key of ``STAGES``."""
    workload: str
    msps: int
    """A key of ``RATES``."""
    level: str
    """Vector instructions."""
    threads: int
    channels: int
    """Signals, PRNs or emitters worked on."""
    signal_s: float
    """Signal in one run; of acquisition, in the recording."""
    recording: str = ""
    """Path, for stages that read one."""

    @property
    def rate(self) -> Rate:
        """Its samples."""
        return RATES[self.msps]


def seconds(action: Callable[[], object]) -> float:
    """How long something takes."""
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def receiver(job: Job, folder: Path) -> Action:
    """What ``sdr-spoof track`` does once it has acquired: file to result file, loops and all."""
    from sdr_spoof.config import load_config  # noqa: PLC0415 - scipy is slow to import
    from sdr_spoof.sinks.hdf5 import Result, write_result  # noqa: PLC0415
    from sdr_spoof.studies.tracking import seeds  # noqa: PLC0415
    from sdr_spoof.tracking import track  # noqa: PLC0415

    recording = open_recording(job.recording)
    whole = job.workload == "W2"
    config = load_config()
    tracking = config.tracking.model_copy(update={"qmboc": whole, "data_component": whole})
    config = config.model_copy(update={"tracking": tracking})
    signals = tracked(job.rate)
    found = [a for a in seeds(scenario(job.rate, job.signal_s)) if a.signal in signals]

    def work() -> None:
        log = track(recording, found, tracking, threads=job.threads, rows_in=folder)
        result = Result.of(recording, config, acquisitions=found, log=log)
        write_result(folder / "result.h5", result, force=True)
        ends = [t.part(t.epochs - 1, t.epochs).state for t in log.signals]
        if not all(end >= State.SYNCED for end in ends):
            raise SdrSpoofError(
                f"{job.msps} Msps, {job.signal_s:g} s: not every signal is synchronised at the "
                "end, and such a run says nothing; take longer recordings"
            )

    return partial(seconds, work)


def engine(job: Job, folder: Path) -> Action:
    """The correlator engine without loops."""
    groups = shared_out(channels(job.workload, job.rate), job.threads, job.rate)
    return running(job.rate, groups, taps(job.rate), job.signal_s)


def channel(job: Job, folder: Path) -> Action:
    """What one B1I channel more costs the engine: the slope over engines of several sizes."""
    sizes = [k * job.channels // 2 for k in (1, 2, 3)]
    engines = [
        running(job.rate, [b1i(job.rate, size)], taps(job.rate), job.signal_s) for size in sizes
    ]
    return lambda: float(np.polyfit(sizes, [run() for run in engines], 1)[0])


def acquisition(job: Job, folder: Path) -> Action:
    """The search of the recording's first samples for all PRNs of a signal."""
    from sdr_spoof.acquisition import AcquisitionConfig, acquire  # noqa: PLC0415

    recording = open_recording(job.recording)
    signals = SEARCHES[job.workload]
    work = partial(acquire, recording, AcquisitionConfig(), signals=signals, threads=job.threads)
    return partial(seconds, work)


def synthesis(job: Job, folder: Path) -> Action:
    """Samples of B1I and the B1C pilot of all satellites, with noise, to memory."""
    plan = scenario(job.rate, job.signal_s, tracked(job.rate))
    synthesizer = open_synthesizer(plan, job.threads)
    return partial(seconds, partial(synthesizer.generate, 0, plan.recording.sample_count))


STAGES = {
    "receiver": receiver,
    "engine": engine,
    "channel": channel,
    "acquisition": acquisition,
    "synthesis": synthesis,
}


def running(
    rate: Rate,
    groups: Sequence[Sequence[Channel]],
    offsets: Sequence[int],
    signal_s: float,
    bands: Sequence[float] = (),
) -> Action:
    """An engine with these channels in each thread, all of them under way.

    Bands (carriers in Hz) are mixed in each thread, with or without channels.
    """
    made = _core.EngineBench(
        rate.sample_format, rate.sample_rate_hz, rate.lo_hz, groups, offsets, bands=bands
    )
    samples = _noise(rate)
    made.feed(samples, 1)
    return partial(seconds, partial(made.feed, samples, round(signal_s / _FED_S)))


def _noise(rate: Rate) -> NDArray[np.uint8]:
    """Bytes of samples without a signal: what they hold does not matter to the speed."""
    bits, _ = _core.sample_format(rate.sample_format)
    count = round(_FED_S * rate.sample_rate_hz) * bits // 8
    values = np.random.default_rng(1).normal(0.0, 16.0, count)
    return np.clip(np.round(values), -127, 127).astype(np.int8).view(np.uint8)
