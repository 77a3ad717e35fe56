"""Output: nothing is overwritten, a full disk and a closed pipe are reported, JSON is clean."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from commands import REAL, SCRIPT, failing, run, scenario_file


@pytest.mark.parametrize("command", ["info", "acquire", "track"])
def test_output_is_not_overwritten(
    command: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    noise_file: Callable[..., Path],
) -> None:
    out = tmp_path / "out"
    out.write_text("mine")
    message = failing(capsys, command, noise_file(), "-o", out)[1]
    assert "out: exists already; add --force to replace it" in message
    assert out.read_text() == "mine"
    message = failing(capsys, command, noise_file(), "-o", tmp_path / "none" / "out")[1]
    assert "does not exist; create it first" in message


def test_process_does_not_overwrite(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], noise_file: Callable[..., Path]
) -> None:
    report = tmp_path / "out" / "report.html"
    report.parent.mkdir()
    report.write_text("mine")
    message = failing(capsys, "process", noise_file(), "-o", report.parent)[1]
    assert "report.html: exists already" in message
    assert report.read_text() == "mine"
    assert list(report.parent.iterdir()) == [report]


def no_room() -> None:
    """Let the process write no file beyond 4 kB, as if the disk were full."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


@pytest.mark.parametrize("command", ["info", "acquire", "track", "process"])
def test_disk_full_while_writing(command: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    flags = [] if command == "info" else ["--signals", "L1CA", "--prns", "1-3,26"]
    result = run(command, REAL, *flags, "-o", out, preexec_fn=no_room)
    assert result.returncode == 1
    assert result.stdout == ""
    assert re.search(r"out(/result\.h5)?: cannot be written: ", result.stderr)
    assert "Traceback" not in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["synth", "demo"])
def test_disk_full_while_synthesising(command: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    scenario = [] if command == "demo" else [scenario_file(tmp_path)]
    result = run(command, *scenario, "-o", out, preexec_fn=no_room)
    assert result.returncode == 1
    assert result.stdout == ""
    assert "cannot be written: " in result.stderr
    assert "nothing was kept" in result.stderr
    assert "Traceback" not in result.stderr
    assert [p for p in tmp_path.iterdir() if p.suffix != ".toml"] == []


def test_synth_and_demo_do_not_overwrite(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = scenario_file(tmp_path)
    for name in ("demo.sigmf-data", "demo.sigmf-meta", "demo.truth.json"):
        (tmp_path / name).write_text("mine")
        message = failing(capsys, "synth", path, "-o", tmp_path / "demo")[1]
        assert f"{name}: exists already" in message
        message = failing(capsys, "demo", "-o", tmp_path)[1]
        assert f"{name}: exists already" in message
        assert (tmp_path / name).read_text() == "mine"
        (tmp_path / name).unlink()
    assert "no such folder" in failing(capsys, "synth", path, "-o", tmp_path / "none" / "x")[1]


def test_output_folder_that_is_a_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], noise_file: Callable[..., Path]
) -> None:
    path = noise_file()
    assert "is a file; name a folder" in failing(capsys, "process", path, "-o", path)[1]
    assert "is a file; name a folder" in failing(capsys, "demo", "-o", path)[1]


def test_broken_pipe() -> None:
    """`sdr-spoof info REC --json | true` neither hangs nor prints a traceback."""
    reader, writer = os.pipe()
    os.close(reader)
    try:
        result = subprocess.run(
            [str(SCRIPT), "info", str(REAL), "--json"],
            stdout=writer,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            timeout=60,
        )
    finally:
        os.close(writer)
    assert result.returncode == 1
    assert result.stderr == ""


def test_json_is_one_object_and_nothing_else() -> None:
    for command in ("info", "acquire"):
        flags = ["--signals", "L1CA", "--prns", "26-27"] if command == "acquire" else []
        result = run(command, REAL, *flags, "--json")
        assert result.returncode == 0
        assert result.stderr == ""
        data = json.loads(result.stdout)
        assert data["format"]["sample_format"] == "ci8"
    assert [a["prn"] for a in data["acquisitions"] if a["detected"]] == [26]
    assert data["config"]["acquisition"]["pfa"] > 0
