"""Time of the whole chain, stage by stage: ``python benches/chain.py [--seconds S] [--threads N]``.

Eight BDS satellites high in a sky, B1I at 10 Msps. ``process`` (search, loops, detectors, fixes,
result file and report) runs in this process, ``--runs`` times; wall and CPU time of each stage of
the best run are printed, and of the first run as a whole. The start of Python and its modules is
not counted, but for that of the processes that draw. On a machine that others use too, CPU time is
what compares: half of it, that of the drawing processes with it, is the least that two cores take.
"""

from __future__ import annotations

import argparse
import os
import resource
import time
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import scipy

from sdr_spoof.config import load_config
from sdr_spoof.pipeline import process
from sdr_spoof.scenario import Scenario, builtin_scenario, synthesize
from sdr_spoof.sources import open_recording

if TYPE_CHECKING:
    from collections.abc import Iterator

EIGHT_ABOVE_DEG = 52.4


def scenario(duration_s: float) -> Scenario:
    """The static sky down to its eighth satellite."""
    values = builtin_scenario("sky-static").model_dump()
    values["recording"]["duration_s"] = duration_s
    values["sky"]["elevation_mask_deg"] = EIGHT_ABOVE_DEG
    return Scenario.model_validate(values)


def timed(meta: Path, out: Path, threads: int) -> tuple[list[tuple[str, float, float]], str]:
    """Stages with their wall and CPU time, the whole last, and what was found."""
    spent: list[tuple[str, float, float]] = []

    @contextmanager
    def stages(name: str) -> Iterator[None]:
        wall, cpu = time.perf_counter(), time.process_time()
        yield None
        spent.append((name, time.perf_counter() - wall, time.process_time() - cpu))

    before = _children_s()
    with stages("Whole chain"):
        recording = open_recording(meta)
        found = process(
            recording, load_config(), out=out, threads=threads, force=True, stages=stages
        )
    fixes = found.located.fixes.fixed.sum() if found.located else 0
    drawing_s = _children_s() - before
    return (
        spent,
        f"{len(found.log.signals)} signals, {fixes} fixes; drawing elsewhere {drawing_s:.2f} s",
    )


def _children_s() -> float:
    """CPU time of processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Make the recording, process it, print a table."""
    _ = scipy.special, scipy.ndimage  # loaded when they are named
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="of signal")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=3)
    asked = parser.parse_args()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # installed modules are compiled
    with TemporaryDirectory(prefix="sdr-spoof-chain-") as folder:
        meta = synthesize(scenario(asked.seconds), Path(folder) / "sky")
        runs = [timed(meta, Path(folder) / "out", asked.threads) for _ in range(asked.runs)]
    spent, found = min(runs, key=lambda run: run[0][-1][1])
    first_s = runs[0][0][-1][1]
    print(f"{found}, {asked.threads} threads; first run {first_s:.2f} s")
    print("| stage | wall, s | times real time | CPU, s |\n|---|---|---|---|")
    for name, wall, cpu in spent:
        print(f"| {name} | {wall:.2f} | {asked.seconds / wall:.1f} | {cpu:.2f} |")


if __name__ == "__main__":
    main()
