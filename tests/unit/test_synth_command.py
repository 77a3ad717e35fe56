"""``sdr-spoof synth``: names, lists, speed-up."""

import json
from pathlib import Path

import pytest

from sdr_spoof.cli import main
from sdr_spoof.scenario import scenario_names

SHORT = """
[recording]
duration_s = 0.4
sample_rate_hz = 6e6
lo_hz = 1561e6
sample_format = "ci8"
[[satellite]]
prn = 27
signals = ["B1I"]
[[attack]]
prn = 27
signals = ["B1I"]
start_s = 0.2
power_ramp_s = 0.1
"""


def test_list_names_every_scenario(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["synth", "--list", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["scenarios"]
    assert [r["name"] for r in rows] == scenario_names()
    assert main(["synth", "--list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in scenario_names())


def test_speed_up(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "short.toml"
    path.write_text(SHORT)
    out = tmp_path / "fast"
    assert main(["synth", str(path), "--speed-up", "4", "-o", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["duration_s"] == pytest.approx(0.1)
    told = json.loads(out.with_suffix(".truth.json").read_text())
    assert told["sample_count"] == 600_000
    assert told["attacks"][0]["start_s"] == pytest.approx(0.05)
    assert told["attacks"][0]["power_ramp_end_s"] == pytest.approx(0.075)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "SCENARIO: missing"),
        (["quick"], "--output: missing"),
        (["quik", "-o", "x"], "did you mean 'quick'"),
        (["quick", "-o", "x", "--speed-up", "0"], "speed-up 0: must be a number above 0"),
    ],
)
def test_mistakes_are_named(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["synth", *arguments]) == 2
    assert message in capsys.readouterr().err
