"""Mistakes in what a command is given end in a clear message and a non-zero exit."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from commands import SCENARIO, failing, scenario_file

from sdr_spoof.cli import COMMANDS, main

READS = [c.name for c in COMMANDS if c.name in ("info", "acquire", "track", "process")]


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


@pytest.mark.parametrize("command", [c.name for c in COMMANDS])
def test_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main([command, "--help"])
    assert stopped.value.code == 0
    assert "--json" in capsys.readouterr().out
