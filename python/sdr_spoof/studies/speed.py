"""What the correlator engine costs: against sample rate, channels, taps and threads.

All figures are core time for a millisecond of signal, without loops, at the best level of vector
instructions; every channel is under way before timing begins. Each point is the shortest of
many short runs: whatever else the machine does can only make a run longer.

- sample rate: the front end of one band, and one channel more (slope over 12 to 36 channels), on
  complex samples around the band, with taps 8 samples apart and as far apart in time as these are
  at 120 Msps;
- channels: an engine with 0 to 48 channels of one kind, real samples at 120 Msps;
- taps: one channel more with 1 to 24 taps, on the raster of 8 samples (eight of them are one
  load) and next to each other (the first eight are a load each);
- threads: W1 and W2, wall time, with more threads than cores too.
"""

from __future__ import annotations

import csv
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof import _core
from sdr_spoof.bench.jobs import running
from sdr_spoof.bench.machine import cores, load_average, machine
from sdr_spoof.bench.workloads import RATES, Rate, alike, channels, shared_out, taps
from sdr_spoof.signals import signal_spec

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from sdr_spoof.bench.workloads import Channel
    from sdr_spoof.progress import Progress

KINDS = {
    "B1I": ("B1I", "Bpsk", False),
    "B1C, BOC(1,1)": ("B1CP", "Boc11", False),
    "B1C, QMBOC and data": ("B1CP", "Qmboc", True),
}
"""Kinds of channel: signal, modulation, data component too."""
MSPS = (5, 10, 20, 40, 60, 80, 120)
CHANNELS = (0, 6, 12, 18, 24, 36, 48)
TAPS = (1, 2, 4, 6, 8, 9, 12, 16, 17, 20, 24)
SLOPE = (12, 24, 36)
RASTER = (-16, -8, 0, 8, 16)
CLOSE = ", close taps"
"""Marks channels whose taps are as far apart in time as the raster at 120 Msps."""
QMBOC_FROM_MSPS = 20
"""Below, the BOC(6,1) part is not in the band."""


@dataclass(frozen=True)
class Cost:
    """A point of a picture."""

    against: str
    """What is varied: msps, channels, taps or threads."""
    value: float
    what: str
    """For example ``front end`` or ``B1I``."""
    us_per_ms: float
    """Core time; of threads, wall time."""


def run(
    output: Path, *, signal_s: float = 0.1, repeats: int = 25, progress: Progress | None = None
) -> dict[str, Any]:
    """Measure; write speed_scaling.{csv,png} and speed.json.

    Args:
        output: folder to write to.
        signal_s: signal in one run.
        repeats: runs of each point.
        progress: called with (points done, points in all).

    Returns:
        What speed.json holds.
    """
    here = machine()
    timer = _Timer(signal_s, repeats)
    costs: list[Cost] = []
    for done, picture in enumerate(_PICTURES):
        costs += picture(timer)
        if progress:
            progress(done + 1, len(_PICTURES))
    table = [asdict(c) for c in costs]
    level = _core.simd_level()
    after = load_average()
    result = {"machine": asdict(here), "level": level, "load_after": after, "costs": table}
    output.mkdir(parents=True, exist_ok=True)
    with (output / "speed_scaling.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    from .speed_figure import draw  # noqa: PLC0415 - matplotlib is slow to import

    draw(output / "speed_scaling.png", costs, cores=here.cores)
    (output / "speed.json").write_text(json.dumps(result, indent=1) + "\n")
    return result


@dataclass(frozen=True)
class _Timer:
    """How each point is timed."""

    signal_s: float
    repeats: int

    def engine(
        self,
        rate: Rate,
        groups: Sequence[Sequence[Channel]],
        offsets: Sequence[int],
        bands: Sequence[float] = (),
    ) -> float:
        """Microseconds for a millisecond of signal, of the shortest run."""
        action = running(rate, groups, offsets, self.signal_s, bands)
        return min(action() for _ in range(self.repeats)) / self.signal_s * 1e3

    def slope(self, rate: Rate, kind: str, offsets: Sequence[int]) -> float:
        """Microseconds for a millisecond of one channel more."""
        costs = [self.engine(rate, [_channels(rate, kind, n)], offsets) for n in SLOPE]
        return float(np.polyfit(SLOPE, costs, 1)[0])


def _channels(rate: Rate, kind: str, count: int) -> list[Channel]:
    signal, modulation, data = KINDS[kind]
    prns = signal_spec("B1CP").prns[:count]  # they send B1I too
    return alike(rate, signal, modulation, prns, data=data)


def _carrier_hz(kind: str) -> float:
    return signal_spec(KINDS[kind][0]).carrier_hz


def _against_rate(timer: _Timer) -> Iterator[Cost]:
    for msps in MSPS:
        for kind in KINDS:
            # Off the carrier a little, as receivers are.
            rate = Rate(msps * 1e6, "ci8", _carrier_hz(kind) - 0.3e6, (), ())
            if kind == "B1I":
                cost = timer.engine(rate, [[]], RASTER, [_carrier_hz(kind)])
                yield Cost("msps", msps, "front end of a band", cost)
            if "QMBOC" not in kind or msps >= QMBOC_FROM_MSPS:
                yield Cost("msps", msps, kind, timer.slope(rate, kind, RASTER))
                if msps < max(MSPS):
                    cost = timer.slope(rate, kind, taps(rate))
                    yield Cost("msps", msps, kind + CLOSE, cost)


def _against_channels(timer: _Timer) -> Iterator[Cost]:
    rate = RATES[120]
    for kind in KINDS:
        for count in CHANNELS:
            groups = [_channels(rate, kind, count)]
            cost = timer.engine(rate, groups, RASTER, [_carrier_hz(kind)])
            yield Cost("channels", count, kind, cost)


def _against_taps(timer: _Timer) -> Iterator[Cost]:
    rate = RATES[120]
    for name, step in (("8 samples apart", 8), ("next to each other", 1)):
        for count in TAPS:
            offsets = [(k - count // 2) * step for k in range(count)]
            yield Cost("taps", count, name, timer.slope(rate, "B1I", offsets))


def _against_threads(timer: _Timer) -> Iterator[Cost]:
    rate = RATES[120]
    for workload in rate.workloads:
        for threads in range(1, 2 * cores() + 1):
            groups = shared_out(channels(workload, rate), threads, rate)
            yield Cost("threads", threads, workload, timer.engine(rate, groups, RASTER))


_PICTURES = (_against_rate, _against_channels, _against_taps, _against_threads)
