"""Ctrl-C half-way: exit 130, and what was done stays readable and says that it is partial."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from pathlib import Path

import pytest
from commands import REAL, SCRIPT

from sdr_spoof.cli import main
from sdr_spoof.info import inspect
from sdr_spoof.sinks.hdf5 import read_result
from sdr_spoof.sources import open_recording

SCENARIO = """
[recording]
duration_s = {duration_s}
sample_rate_hz = 5e6
lo_hz = 1575.42e6
sample_format = "ci8"
[[satellite]]
prn = 27
signals = ["B1C"]
"""


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """40 s of one satellite."""
    folder = tmp_path_factory.mktemp("recording")
    scenario = folder / "scenario.toml"
    scenario.write_text(SCENARIO.format(duration_s=40.0))
    assert main(["synth", str(scenario), "-o", str(folder / "long")]) == 0
    return folder / "long.sigmf-meta"


def interrupted(stage: str, *arguments: str | Path, percent: int = 1) -> str:
    """Run a command, press Ctrl-C soon after a stage's bar shows ``percent``; returns stderr."""
    process = subprocess.Popen(
        [str(SCRIPT), *map(str, arguments), "--progress", "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stderr is not None
    seen = b""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        seen += process.stderr.read1(4096)  # type: ignore[attr-defined]
        if any(f" {n} %" in line for line in _lines(seen, stage) for n in range(percent, 60)):
            break
    process.send_signal(signal.SIGINT)
    _, rest = process.communicate(timeout=60)
    text = (seen + rest).decode()
    assert process.returncode == 130, text
    assert "Traceback" not in text
    return text


def _lines(seen: bytes, stage: str) -> list[str]:
    return [t for t in seen.decode(errors="replace").split("\r") if stage in t]


def test_synth(tmp_path: Path) -> None:
    scenario = tmp_path / "scenario.toml"
    scenario.write_text(SCENARIO.format(duration_s=300.0))
    text = interrupted("Synthesising", "synth", scenario, "-o", tmp_path / "cut")
    assert "marked partial" in text
    recording = open_recording(tmp_path / "cut.sigmf-meta")
    assert 0 < recording.duration_s < 300
    assert "partial: synthesis was interrupted" in inspect(recording).warnings
    truth = json.loads((tmp_path / "cut.truth.json").read_text())
    assert truth["partial"] is True
    assert truth["sample_count"] == recording.sample_count
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize("command", ["track", "process"])
def test_track_and_process(command: str, recording: Path, tmp_path: Path) -> None:
    flags = ["--signals", "B1CP", "--prns", "27", "--threads", "1"]
    text = interrupted("Tracking", command, recording, *flags, "-o", tmp_path / "out")
    assert "the results are partial" in text
    path = tmp_path / "out" / "result.h5" if command == "process" else tmp_path / "out"
    result = read_result(path)
    assert result.partial
    assert result.log is not None
    assert 0 < result.log.duration_s < 40
    (track,) = result.log.signals
    assert track.time_s.size > 0
    if command == "process":
        report = (tmp_path / "out" / "report.html").read_text()
        assert "Tracking was interrupted: this report covers the first" in report


def test_demo_keeps_the_recording_and_nothing_half_made(tmp_path: Path) -> None:
    text = interrupted("Synthesising", "demo", "-o", tmp_path / "demo", "--threads", "1")
    assert "marked partial" in text
    assert open_recording(tmp_path / "demo" / "demo.sigmf-meta").extra["partial"] is True
    assert not (tmp_path / "demo" / "report.html").exists()


def test_process_while_it_searches(recording: Path, tmp_path: Path) -> None:
    slow = ["--signals", "B1CP", "--acquisition-doppler-max-hz", "20000"]
    text = interrupted("Acquiring", "process", recording, *slow, "-o", tmp_path / "out", percent=0)
    assert "interrupted" in text
    assert not (tmp_path / "out").exists()


def test_acquire(tmp_path: Path) -> None:
    """Ctrl-C during a search: exit 130, a message, no output."""
    # Wide and long enough to last several seconds, in short steps.
    slow = ["--acquisition-doppler-max-hz", "100000", "--acquisition-blocks-short", "90"]
    command = [SCRIPT, "acquire", REAL, "--signals", "L1CA", *slow, "-o", tmp_path / "out"]
    process = subprocess.Popen(
        [*map(str, command), "--progress"],
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stderr is not None
    first = process.stderr.read(1)  # the progress bar: the search has begun
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert out == ""
    assert "interrupted" in first + err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []
