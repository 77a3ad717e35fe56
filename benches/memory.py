"""Most memory that ``process`` uses, for recordings of several lengths: python benches/memory.py.

Twelve satellites with B1I and B1C, standing still, so that 18 s (the length of the pilot's
secondary code) can be played over and over without a seam. With ``--sky`` the whole recording is
made instead, the static sky of 19 satellites with their messages, B1I at 5 Msps (10 MB a second of
disk, taken away afterwards), so that positions are computed too. Each length runs in a process of
its own; Linux only.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from sdr_spoof import load_config, open_recording, process, synthesize
from sdr_spoof.scenario import Scenario, builtin_scenario

PERIOD_S = 18.0
PRNS = range(19, 31)


class Repeating:
    """A recording played over and over."""

    def __init__(self, path: Path, duration_s: float) -> None:
        once = open_recording(path)
        self._once = once
        self.path, self.format, self.extra = once.path, once.format, once.extra
        self.start, self.duration_s = None, duration_s
        self.sample_count = round(duration_s * once.format.sample_rate_hz)
        self.signals, self.check_signal = once.signals, once.check_signal

    def read_raw(self, start: int, count: int) -> np.ndarray:
        pieces = []
        stop = min(start + count, self.sample_count)
        while start < stop:
            at = start % self._once.sample_count
            more = min(stop - start, self._once.sample_count - at)
            pieces.append(self._once.read_raw(at, more))
            start += more
        return pieces[0] if len(pieces) == 1 else np.concatenate(pieces)


def scenario(rate_hz: float, duration_s: float) -> Scenario:
    """Real samples where they hold both bands, complex ones where the rate is lower."""
    real = rate_hz >= 100e6
    recording = {
        "duration_s": duration_s,
        "sample_rate_hz": rate_hz,
        "lo_hz": 1538.259e6 if real else 1568.259e6,
        "sample_format": "ri8" if real else "ci8",
    }
    satellites = [
        {"prn": prn, "signals": ["B1I", "B1C"], "cn0_dbhz": 47.0, "delay_ms": 71.3 + 3.217 * k}
        for k, prn in enumerate(PRNS)
    ]
    return Scenario.model_validate({"recording": recording, "satellite": satellites})


def sky(duration_s: float) -> Scenario:
    values = builtin_scenario("sky-static").model_dump()
    values["recording"] |= {"duration_s": duration_s, "sample_rate_hz": 5e6, "bandwidth_hz": 4.5e6}
    return Scenario.model_validate(values)


def most_memory_mib() -> float:
    status = Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


@contextmanager
def stages(label: str):
    start = time.monotonic()
    yield None
    print(f"  {label}: {time.monotonic() - start:.1f} s, {most_memory_mib():.0f} MiB", flush=True)


def run(path: Path, minutes: float, *, whole: bool) -> None:
    print(f"{minutes:g} minutes")
    chosen = {} if whole else {"signals": ["B1I", "B1CP"], "prns": PRNS}
    done = process(
        open_recording(path) if whole else Repeating(path, 60.0 * minutes),  # type: ignore[arg-type]
        load_config(),
        out=path.parent / "out",
        force=True,
        stages=stages,
        **chosen,
    )
    fixes = done.located.fixes.fixed.sum() if done.located else 0
    rows = sum(track.epochs for track in done.log.signals)
    size = done.result_path.stat().st_size / 1e6
    most = most_memory_mib()
    print(f"  {rows} rows, {fixes} fixes, result of {size:.0f} MB: {most:.0f} MiB at most")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rate-msps", type=float, default=20.0)
    parser.add_argument("--minutes", type=float, nargs="+", default=[1.0, 10.0])
    parser.add_argument("--recording", type=Path, help="run on this one, made before")
    parser.add_argument("--sky", action="store_true", help="a whole sky, with positions")
    arguments = parser.parse_args()
    if arguments.recording is not None:
        run(arguments.recording, arguments.minutes[0], whole=arguments.sky)
        return
    with tempfile.TemporaryDirectory(prefix="sdr-spoof-memory-") as folder:
        period = Path(folder) / "period"
        for minutes in arguments.minutes:
            if arguments.sky:
                meta = synthesize(sky(60.0 * minutes), Path(folder) / "sky", force=True)
            elif not period.with_suffix(".sigmf-meta").exists():
                duration_s = min(PERIOD_S, 60.0 * max(arguments.minutes))
                meta = synthesize(scenario(1e6 * arguments.rate_msps, duration_s), period)
            command = [sys.executable, __file__, "--recording", meta, "--minutes", minutes]
            command += ["--sky"] * arguments.sky
            subprocess.run([str(word) for word in command], check=True)


if __name__ == "__main__":
    main()
