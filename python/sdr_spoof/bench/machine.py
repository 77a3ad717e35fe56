"""What was measured on."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from pathlib import Path

from sdr_spoof import _core


@dataclass(frozen=True)
class Machine:
    """The machine; a load beside the benchmark's own makes it slower."""

    processor: str
    cores: int
    """That this process may use."""
    levels: tuple[str, ...]
    """Vector instructions that it has, lowest first."""
    load_average: float
    """Of the last minute, when the benchmark began."""


def machine() -> Machine:
    """The machine, and how busy it is."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    name = names[0] if names else platform.processor() or platform.machine()
    return Machine(name, cores(), tuple(_core.simd_levels()), load_average())


def load_average() -> float:
    """Processes that wanted to run in the last minute, on average."""
    return round(os.getloadavg()[0], 2)


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def thread_counts() -> list[int]:
    """1, 2, 4 ... and one per core."""
    most = cores()
    return sorted({min(2**k, most) for k in range(most.bit_length() + 1)})


def peak_memory_mb() -> float:
    """Most memory that this process has held."""
    # Linux hands ru_maxrss down from the process that started this one: VmHWM is its own.
    status = Path("/proc/self/status")
    if status.exists():
        lines = status.read_text().splitlines()
        peak = [int(line.split()[1]) for line in lines if line.startswith("VmHWM")]
        if peak:
            return peak[0] * 1024 / 1e6
    import resource  # noqa: PLC0415 - Unix only

    unit = 1 if platform.system() == "Darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6
