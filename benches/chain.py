"""Time of the whole chain, stage by stage: ``python benches/chain.py [--seconds S] [--threads N]``.

Eight BDS satellites high in a sky, B1I at 10 Msps. ``process`` (search, loops, detectors, fixes,
result file and report) runs in this process; each stage's wall and CPU time is printed, the start
of Python and its modules not counted. On a machine that others use too, CPU time is what compares:
half of it is the least that two cores can take.
"""

from __future__ import annotations

import argparse
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


def main() -> None:
    """Make the recording, process it, print a table."""
    _ = scipy.special, scipy.ndimage  # loaded when they are named
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="of signal")
    parser.add_argument("--threads", type=int, default=2)
    asked = parser.parse_args()
    spent: list[tuple[str, float, float]] = []

    @contextmanager
    def stages(name: str) -> Iterator[None]:
        wall, cpu = time.perf_counter(), time.process_time()
        yield None
        spent.append((name, time.perf_counter() - wall, time.process_time() - cpu))

    with TemporaryDirectory(prefix="sdr-spoof-chain-") as folder:
        meta = synthesize(scenario(asked.seconds), Path(folder) / "sky")
        with stages("Whole chain"):
            found = process(
                open_recording(meta),
                load_config(),
                out=Path(folder) / "out",
                threads=asked.threads,
                stages=stages,
            )
    fixes = found.located.fixes.fixed.sum() if found.located else 0
    print(f"{len(found.log.signals)} signals, {fixes} fixes, {asked.threads} threads")
    print("| stage | wall, s | times real time | CPU, s |\n|---|---|---|---|")
    for name, wall, cpu in spent:
        print(f"| {name} | {wall:.2f} | {asked.seconds / wall:.1f} | {cpu:.2f} |")


if __name__ == "__main__":
    main()
