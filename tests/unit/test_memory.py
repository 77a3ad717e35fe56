"""The memory of the process does not grow with the length of the recording."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SATELLITES, RATE_HZ, LO_HZ = 12, 4e6, 1560.598e6
GROWTH_BYTES = 3e6
"""Less than a tenth of the rows that the longer recording gives more."""
ROW_BYTES = 8 * 9 + 1 + 8 * 7
RUN = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from test_memory import track_to_file
track_to_file(Path(sys.argv[2]), float(sys.argv[3]))
"""


class Repeating:
    """Twelve B1I satellites without Doppler, 20 ms of them over and over: their NH code fits."""

    def __init__(self, duration_s: float) -> None:
        from sdr_spoof import _core  # noqa: PLC0415 - in the process that is measured
        from sdr_spoof.sources import RecordingFormat  # noqa: PLC0415

        self.path = Path("repeating")
        self.gain = None
        self.format = RecordingFormat(sample_format="ci8", sample_rate_hz=RATE_HZ, lo_hz=LO_HZ)
        self.sample_count = round(duration_s * RATE_HZ)
        emitters = [_core.Emitter("B1I", prn, 50.0, delay_s=0.07 + 71e-6 * prn) for prn in prns()]
        self.found = [_seed(e, prn) for prn, e in zip(prns(), emitters, strict=True)]
        synthesizer = _core.Synthesizer("ci8", RATE_HZ, LO_HZ, emitters, noise_rms_lsb=16.0)
        self._period = synthesizer.generate(0, round(0.02 * RATE_HZ))

    def read_raw(self, start: int, count: int):
        import numpy as np  # noqa: PLC0415

        first = 2 * start % self._period.size
        bytes_ = 2 * max(0, min(count, self.sample_count - start))
        periods = -(-(first + bytes_) // self._period.size)
        return np.tile(self._period, periods)[first : first + bytes_]

    def check_signal(self, signal: str) -> None:
        pass

    def signals(self) -> list[str]:
        return ["B1I"]


def prns() -> range:
    return range(19, 19 + SATELLITES)


def _seed(emitter, prn: int):
    import numpy as np  # noqa: PLC0415

    from sdr_spoof.records import Acquisition  # noqa: PLC0415

    phase = float(emitter.code_phase_chips(np.zeros(1))[0])
    delay_s = -phase % 2046 / 2.046e6
    return Acquisition("B1I", prn, True, 0, 0.0, delay_s, 50.0, 99.0, 9.0, 50.0)


def track_to_file(path: Path, duration_s: float) -> None:
    """Track with 1 ms epochs, write the result, print the most memory that was used, in bytes."""
    from sdr_spoof.config import Config  # noqa: PLC0415
    from sdr_spoof.sinks.hdf5 import Result, write_result  # noqa: PLC0415
    from sdr_spoof.tracking import TrackingConfig, track  # noqa: PLC0415

    source = Repeating(duration_s)
    config = TrackingConfig(integration_ms=1)
    log = track(source, source.found, config, threads=2, rows_in=path.parent)
    write_result(path, Result(str(source.path), source.format, Config().model_dump(), log=log))
    status = Path("/proc/self/status").read_text()
    print(1024 * int(status.partition("VmHWM:")[2].split()[0]))


def run(folder: Path, duration_s: float) -> tuple[int, int]:
    """(Most memory used, size of the result), in bytes."""
    path = folder / f"{duration_s}.h5"
    command = [sys.executable, "-c", RUN, str(Path(__file__).parent), str(path), str(duration_s)]
    memory = int(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return memory, path.stat().st_size


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is read from /proc")
def test_memory_does_not_grow_with_the_recording(tmp_path: Path) -> None:
    (short, small), (long, large) = (run(tmp_path, duration_s) for duration_s in (5.0, 30.0))
    assert large - small > 0.95 * 25.0 * 1000 * SATELLITES * ROW_BYTES
    assert long - short < GROWTH_BYTES
