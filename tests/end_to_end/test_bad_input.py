"""Mistakes end in a clear message on stderr and a non-zero exit; nothing is overwritten."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from sdr_spoof.cli import COMMANDS, main

SCRIPT = Path(sys.executable).with_name("sdr-spoof")
READS = [c.name for c in COMMANDS if c.name in ("info", "acquire", "track", "process")]
RECORDINGS = Path(__file__).parents[1] / "vectors" / "recordings"
REAL = RECORDINGS / "L1_20211202_084700_4MHz_IQ.bin"


def failing(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> tuple[int, str]:
    """Run a command that must fail; returns its exit code and message."""
    code = main([str(a) for a in arguments])
    output = capsys.readouterr()
    assert code != 0
    assert output.out == ""
    assert "Traceback" not in output.err
    return code, output.err


def read_failing(capsys: pytest.CaptureFixture[str], tmp_path: Path, *args: str | Path) -> str:
    """The one message of every command that reads a recording, given the same mistake."""
    messages = set()
    for command in READS:
        out = ["-o", tmp_path / "out"] if command == "process" else []
        messages.add(failing(capsys, command, *args, *out)[1])
    assert len(messages) == 1
    assert not (tmp_path / "out").exists()
    return messages.pop()


def test_missing_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "no such file" in read_failing(capsys, tmp_path, tmp_path / "none.bin")
    assert "cannot be read" in failing(capsys, "synth", tmp_path / "no.toml", "-o", "x")[1]


def test_directory(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "not a file" in read_failing(capsys, tmp_path, tmp_path)


def test_empty_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], noise_file: Callable[..., Path]
) -> None:
    path = noise_file()
    path.write_bytes(b"")
    assert "the file is empty" in read_failing(capsys, tmp_path, path)
    path.write_bytes(b"abcd")
    message = read_failing(capsys, tmp_path, path, "--offset-bytes", "4")
    assert "not longer than offset_bytes" in message


def test_size_not_a_multiple_of_the_sample(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], noise_file: Callable[..., Path]
) -> None:
    path = noise_file()
    path.write_bytes(bytes(1001))
    message = read_failing(capsys, tmp_path, path)
    assert "1001 bytes are not a whole number of ci8 samples" in message
    assert "cut off" in message


def test_format_not_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(bytes(100))
    message = read_failing(capsys, tmp_path, path)
    assert "sample_format, sample_rate_hz, lo_hz not known" in message
    assert "--sample-rate-hz" in message
    message = read_failing(
        capsys, tmp_path, path, "--sample-format", "u8", "--sample-rate-hz", "1e6", "--lo-hz", "0"
    )
    assert "--sample-format: unknown sample format 'u8'; known formats: ri8" in message


def test_unknown_key_in_sidecar(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], noise_file: Callable[..., Path]
) -> None:
    path = noise_file()
    sidecar = Path(f"{path}.toml")
    sidecar.write_text(sidecar.read_text().replace("sample_rate_hz", "sampel_rate_hz"))
    message = read_failing(capsys, tmp_path, path)
    assert "noise.bin.toml: [recording] sampel_rate_hz: unknown key" in message
    assert "did you mean 'sample_rate_hz'?" in message


@pytest.mark.parametrize("command", ["acquire", "track", "process"])
@pytest.mark.parametrize(
    ("changes", "signals", "message"),
    [
        ({"sample_rate_hz": 0.5e6}, ["--signals", "L1CA"], "0.5 Msps is too low for L1CA"),
        ({}, ["--signals", "B1I"], "B1I lies at -14.322 MHz"),
        ({"lo_hz": 1.2e9}, [], "lies at 375.42 MHz"),
        ({}, ["--signals", "L5"], "unknown signal 'L5'; known signals: B1I"),
        ({}, ["--prns", "six"], "--prns: 'six' is neither a number nor a range"),
    ],
)
def test_signal_that_does_not_fit(
    command: str,
    changes: dict[str, float],
    signals: list[str],
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    noise_file: Callable[..., Path],
) -> None:
    out = tmp_path / "out"
    assert message in failing(capsys, command, noise_file(**changes), *signals, "-o", out)[1]
    assert not out.exists()


@pytest.mark.parametrize("command", ["acquire", "track", "process", "demo"])
def test_wrong_configuration(
    command: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    noise_file: Callable[..., Path],
) -> None:
    settings = tmp_path / "settings.toml"
    settings.write_text("[acquisition]\npfaa = 1\n")
    recording = [] if command == "demo" else [noise_file()]
    arguments = [command, *recording, "-o", tmp_path / "out", "--config", settings]
    code, message = failing(capsys, *arguments)
    assert code == 2
    assert "settings.toml: [acquisition] pfaa: unknown key 'pfaa'; did you mean 'pfa'?" in message
    assert not (tmp_path / "out").exists()


def test_unknown_flag_and_command() -> None:
    for arguments in (["acquire", "x", "--no-such-flag"], ["no-such-command"]):
        with pytest.raises(SystemExit) as stopped:
            main(arguments)
        assert stopped.value.code == 2


def test_no_command_prints_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert "process " in failing(capsys)[1]


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


def run(*arguments: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(SCRIPT), *map(str, arguments)],
        text=True,
        capture_output=True,
        check=False,
        timeout=120,
        **options,  # type: ignore[call-overload]
    )


SCENARIO = """
[recording]
duration_s = 2.0
sample_rate_hz = 5e6
lo_hz = 1575.42e6
sample_format = "ci8"
[[satellite]]
prn = 27
signals = ["B1C"]
"""


def scenario_file(folder: Path, text: str = SCENARIO) -> Path:
    path = folder / "scenario.toml"
    path.write_text(text)
    return path


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


def test_interrupt(tmp_path: Path) -> None:
    """Ctrl-C during a search: exit 130, a message, no output."""
    # Wide enough to last several seconds, in short steps.
    slow = ["--acquisition-doppler-max-hz", "30000"]
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


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("duration_s = 2.0", "duration_s = -1", "[recording] duration_s: "),
        ("sample_format", "sampel_format", "unknown key 'sampel_format'; did you mean 'sample_"),
        ('"ci8"', '"u8"', "unknown sample format 'u8'; known formats: ri8"),
        ('["B1C"]', '["B1Q"]', "[[satellite]] (number 1): unknown signal 'B1Q'"),
        ('["B1C"]', '["B1I"]', "[[satellite]] signals: B1I of PRN 27 needs 1560.08"),
        ("5e6", "1e6", "the recording samples 1574.92 to 1575.92 MHz: raise sample_rate_hz"),
        ("[[satellite]]", "[[satelite]]", "unknown key 'satelite'; did you mean 'satellite'?"),
        ("prn = 27", "prn = ", "not valid TOML"),
    ],
)
def test_wrong_scenario(
    old: str, new: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = scenario_file(tmp_path, SCENARIO.replace(old, new))
    code, text = failing(capsys, "synth", path, "-o", tmp_path / "out")
    assert code == 2
    assert text.startswith(f"sdr-spoof: {path}: ")
    assert message in text
    assert list(tmp_path.iterdir()) == [path]


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


def test_cut_off_sigmf_recording(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short = SCENARIO.replace("2.0", "0.1")
    assert main(["synth", str(scenario_file(tmp_path, short)), "-o", str(tmp_path / "a")]) == 0
    capsys.readouterr()
    data = tmp_path / "a.sigmf-data"
    os.truncate(data, data.stat().st_size - 1)
    message = read_failing(capsys, tmp_path, tmp_path / "a.sigmf-meta")
    assert "not a whole number of ci8 samples" in message
    data.unlink()
    assert "no such file" in read_failing(capsys, tmp_path, tmp_path / "a.sigmf-meta")


@pytest.mark.parametrize("command", ["acquire", "track", "process"])
def test_too_short_and_silent_recordings(
    command: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    noise_file: Callable[..., Path],
) -> None:
    out = tmp_path / "out"
    path = noise_file(count=2000)
    flags = ["--signals", "B1C", "--prns", "30", "-o", out]
    assert "too short: B1CD needs 20 ms" in failing(capsys, command, path, *flags)[1]
    path.write_bytes(bytes(1_000_000))
    failing(capsys, command, path, *flags)
    assert not out.exists()


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


@pytest.mark.parametrize("command", [c.name for c in COMMANDS])
def test_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main([command, "--help"])
    assert stopped.value.code == 0
    assert "--json" in capsys.readouterr().out
