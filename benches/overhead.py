"""What reading, rows and the result file cost beside tracking: python benches/overhead.py REC.

CPU time of the main thread per second of signal, the lowest of several runs. For comparison, the
file is also read through a memory map, whose pages must be mapped one by one.
"""

from __future__ import annotations

import argparse
import mmap
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof import Result, acquire, load_config, open_recording, track, tracking, write_result
from sdr_spoof.tracking import BLOCK_BYTES

if TYPE_CHECKING:
    from collections.abc import Callable

    from sdr_spoof import Recording

RUNS = 5


def cpu_s(action: Callable[[], object]) -> float:
    start = time.thread_time()
    action()
    return time.thread_time() - start


def read(recording: Recording) -> None:
    samples = BLOCK_BYTES * 8 // recording.format.bits_per_sample
    for start in range(0, recording.sample_count, samples):
        recording.read_raw(start, samples)


def map_pages(recording: Recording) -> None:
    with recording.path.open("rb") as file:
        size = recording.path.stat().st_size
        for start in range(0, size, BLOCK_BYTES):
            length = min(BLOCK_BYTES, size - start)
            with mmap.mmap(file.fileno(), length, access=mmap.ACCESS_READ, offset=start) as pages:
                pages[:: mmap.PAGESIZE]


def receive(recording: Recording, folder: Path) -> tuple[float, float]:
    """CPU time of taking rows out, and of writing the result."""
    config, spent = load_config(), []
    take_rows = tracking._take_rows

    def timed(*arguments: object) -> None:
        spent.append(cpu_s(lambda: take_rows(*arguments)))

    tracking._take_rows = timed
    found = acquire(recording, config.acquisition)
    log = track(recording, found, config.tracking, rows_in=folder)
    tracking._take_rows = take_rows
    result = Result.of(recording, config, acquisitions=found, log=log)
    return sum(spent), cpu_s(lambda: write_result(folder / "result.h5", result))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recording", type=Path)
    recording = open_recording(parser.parse_args().recording)
    reading = min(cpu_s(lambda: read(recording)) for _ in range(RUNS))
    mapping = min(cpu_s(lambda: map_pages(recording)) for _ in range(RUNS))
    with tempfile.TemporaryDirectory(prefix="sdr-spoof-overhead-") as folder:
        rows, writing = receive(recording, Path(folder))
    size = recording.path.stat().st_size
    for name, spent in (("reading", reading), ("mapping", mapping), ("rows", rows)):
        print(f"{name}: {1e3 * spent / recording.duration_s:.2f} ms per second of signal")
    print(f"reading: {1e-9 * size / reading:.1f} GB/s; result file: {1e3 * writing:.0f} ms in all")


if __name__ == "__main__":
    main()
