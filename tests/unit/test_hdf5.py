"""Result files: round trip, units, the same bytes, never half a file."""

from __future__ import annotations

import dataclasses
import errno
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from sdr_spoof.config import Config
from sdr_spoof.errors import OutputError, RecordingError
from sdr_spoof.records import (
    Acquisition,
    Alarm,
    ComboTrack,
    SatelliteVerdict,
    SignalTrack,
    State,
    TrackLog,
    Verdict,
)
from sdr_spoof.sinks import atomic
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sources import RecordingFormat

FORMAT = RecordingFormat(sample_format="ri8", sample_rate_hz=120e6, lo_hz=1538.259e6)
WRITE = """
import sys
sys.path.insert(0, sys.argv[2])
from test_hdf5 import make_result
from sdr_spoof.sinks.hdf5 import write_result
write_result(sys.argv[1], make_result())
"""
FILL = """
import resource, signal, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from test_hdf5 import make_result
from sdr_spoof.errors import OutputError
from sdr_spoof.sinks.hdf5 import write_result
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
path, result = Path(sys.argv[1]), make_result()
write_result(path, result)
whole = path.read_bytes()
for limit in range(0, len(whole), 1777):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        write_result(path, result, force=True)
    except OutputError as error:
        assert "cannot be written" in str(error)
    else:
        raise SystemExit(f"written within {limit} bytes")
    assert [path] == list(path.parent.iterdir())
    assert path.read_bytes() == whole
"""


def filled(kind: type, n: int, **given: Any) -> Any:
    """A record of arrays of n numbers each."""
    rng = np.random.default_rng(7)
    names = [f.name for f in dataclasses.fields(kind) if f.name not in given]
    return kind(**given, **{name: rng.normal(size=n) for name in names})


def make_result(*, partial: bool = False) -> Result:
    n = 5
    states = np.full(n, State.SYNCED, np.uint8)
    taps = (np.arange(n * 3) * (1 + 2j)).astype(np.complex64).reshape(n, 3)
    offsets = np.array([-1e-7, 0, 1e-7])
    tracks = tuple(
        filled(
            SignalTrack,
            n,
            signal=signal,
            prn=prn,
            tap_offsets_s=offsets,
            prompt_tap=1,
            state=states,
            taps=taps,
        )
        for signal, prn in (("B1I", 19), ("B1CP", 19), ("B1I", 6))
    )
    combo = filled(ComboTrack, n, prn=19, lower="B1I", upper="B1CP", state=states)
    alarm = Alarm(19, "phase_difference_rate", None, 5.25, 6.0, 1.5, 0.7, "Hz")
    verdict = Verdict(
        True,
        (
            SatelliteVerdict(6, "clean", (), "quiet"),
            SatelliteVerdict(19, "spoofed", (alarm, dataclasses.replace(alarm, band="B1C")), "é"),
        ),
        "what is not seen",
    )
    found = Acquisition("B1I", 19, True, 0, -1234.5, 3e-4, 44.25, 30.0, 20.0, 500.0)
    return Result(
        "a.sigmf-data",
        FORMAT,
        Config().model_dump(mode="json"),
        (found, dataclasses.replace(found, prn=20, detected=False, cn0_dbhz=float("nan"))),
        TrackLog("a.sigmf-data", 120e6, 12.5, partial, tracks, (combo,)),
        verdict,
    )


def assert_same(a: Any, b: Any) -> None:
    if dataclasses.is_dataclass(a):
        assert type(a) is type(b)
        for field in dataclasses.fields(a):
            assert_same(getattr(a, field.name), getattr(b, field.name))
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for x, y in zip(a, b, strict=True):
            assert_same(x, y)
    elif isinstance(a, np.ndarray):
        assert a.dtype == b.dtype
        np.testing.assert_array_equal(a, b)
    else:
        np.testing.assert_equal(a, b)  # NaN equals NaN


def test_round_trip(tmp_path: Path) -> None:
    result = make_result()
    write_result(tmp_path / "r.h5", result)
    assert_same(read_result(tmp_path / "r.h5"), result)


def test_round_trip_of_acquisitions_only(tmp_path: Path) -> None:
    result = dataclasses.replace(make_result(), log=None, verdict=None, acquisitions=())
    write_result(tmp_path / "r.h5", result)
    assert_same(read_result(tmp_path / "r.h5"), result)


def test_partial_results_say_so(tmp_path: Path) -> None:
    write_result(tmp_path / "r.h5", make_result(partial=True))
    with h5py.File(tmp_path / "r.h5") as file:
        assert file.attrs["partial"]
    log = read_result(tmp_path / "r.h5").log
    assert log is not None
    assert log.partial


def test_every_dataset_has_units(tmp_path: Path) -> None:
    write_result(tmp_path / "r.h5", make_result())
    units: dict[str, str] = {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            units[name] = item.attrs["units"]

    with h5py.File(tmp_path / "r.h5") as file:
        file.visititems(visit)
    assert len(units) > 40
    track = "tracks/B1I_019/"
    assert units[track + "doppler_hz"] == "Hz"
    assert units[track + "cn0_dbhz"] == "dB-Hz"
    assert units[track + "carrier_phase_cycles"] == "cycle"
    assert units[track + "code_phase_chips"] == "chip"
    assert units[track + "time_s"] == "s"
    assert units[track + "taps"] == "1"
    assert units["acquisitions/sample_index"] == "sample"


def test_two_processes_write_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.h5", "b.h5"):
        subprocess.run(
            [sys.executable, "-c", WRITE, str(tmp_path / name), str(Path(__file__).parent)],
            check=True,
        )
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


def test_nothing_is_replaced_without_force(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    path.write_text("mine")
    with pytest.raises(OutputError, match="exists already; add --force"):
        write_result(path, make_result())
    assert path.read_text() == "mine"
    write_result(path, make_result(), force=True)
    assert read_result(path).recording == "a.sigmf-data"
    assert [p.name for p in tmp_path.iterdir()] == ["r.h5"]


def test_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "r.h5"
    path.write_text("mine")

    def full(*args: object, **more: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "open", full)
    with pytest.raises(OutputError, match=r"r\.h5: cannot be written: no space left on the disk"):
        write_result(path, make_result(), force=True)
    monkeypatch.undo()
    assert path.read_text() == "mine"
    assert [p.name for p in tmp_path.iterdir()] == ["r.h5"]


def test_disk_that_fills_up_at_any_byte(tmp_path: Path) -> None:
    """HDF5 crashes the process, in the end, where one of its own writes fails."""
    command = [sys.executable, "-c", FILL, str(tmp_path / "r.h5"), str(Path(__file__).parent)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stderr) == (0, "")


def test_full_device() -> None:
    with pytest.raises(OSError, match="No space left") as caught, open("/dev/full", "wb") as file:
        file.write(b"x")
        file.flush()
    assert atomic.reason(caught.value).startswith("no space left on the disk; free some")


def test_folder_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        write_result(tmp_path / "none" / "r.h5", make_result())


def test_files_that_are_no_results(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="cannot be read"):
        read_result(tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("hello")
    with pytest.raises(RecordingError, match="cannot be read"):
        read_result(tmp_path / "text.h5")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs["format_version"] = 99
    with pytest.raises(RecordingError, match="not a result file of this version"):
        read_result(tmp_path / "other.h5")
    with h5py.File(tmp_path / "cut.h5", "w") as file:
        file.attrs["format_version"] = 1
    with pytest.raises(RecordingError, match="not a complete result file"):
        read_result(tmp_path / "cut.h5")
