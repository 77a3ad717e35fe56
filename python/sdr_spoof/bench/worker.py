"""Times one job in a process of its own: ``python -m sdr_spoof.bench.worker`` (JSON in and out).

The level of vector instructions is chosen once in a process, and its peak memory is then that of
the job alone.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from sdr_spoof import _core
from sdr_spoof.errors import SdrSpoofError

from .jobs import STAGES, Job
from .machine import peak_memory_mb


@dataclass(frozen=True)
class Timing:
    """What a job took."""

    seconds: list[float]
    """Of each run."""
    peak_mb: float
    """Most memory that the process held."""


def measure(job: Job, repeats: int) -> Timing:
    """Time a job in a new process.

    Raises:
        SdrSpoofError: the job failed.
    """
    run = subprocess.run(
        [sys.executable, "-m", __name__],
        input=json.dumps({"job": asdict(job), "repeats": repeats}),
        env={**os.environ, "SDR_SPOOF_SIMD": job.level},
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode:
        reason = run.stderr.strip().splitlines()[-1:] or [f"exit code {run.returncode}"]
        raise SdrSpoofError(f"the {job.stage} could not be timed: {reason[0]}")
    return Timing(**json.loads(run.stdout))


def timed(job: Job, repeats: int) -> Timing:
    """Time a job in this process, after one run that warms caches.

    Raises:
        SdrSpoofError: the job failed, or this process has other vector instructions.
    """
    if _core.simd_level() != job.level:
        raise SdrSpoofError(f"this process runs at level {_core.simd_level()}, not {job.level}")
    with tempfile.TemporaryDirectory(prefix="sdr-spoof-bench-") as folder:
        action = STAGES[job.stage](job, Path(folder))
        action()
        seconds = [action() for _ in range(repeats)]
    return Timing(seconds, peak_memory_mb())


def _main() -> None:
    asked = json.load(sys.stdin)
    try:
        timing = timed(Job(**asked["job"]), asked["repeats"])
    except SdrSpoofError as error:
        sys.exit(str(error))
    json.dump(asdict(timing), sys.stdout)


if __name__ == "__main__":
    _main()
