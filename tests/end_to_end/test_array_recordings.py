"""Three antennas, a moving vehicle, one counterfeit satellite: from samples to the verdict."""

import json
from pathlib import Path

import pytest
from commands import failing, run

from sdr_spoof.scenario.sky.orbits import DEFAULT

ELEMENTS = "0,0,0;0.38,0,0;0.19,0.329,0"


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    folder = tmp_path_factory.mktemp("array")
    done = run("synth", "array", "--speed-up", "2.4", "-o", str(folder / "rec"))
    assert done.returncode == 0, done.stderr
    return [str(folder / f"rec.a{k}.sigmf-meta") for k in range(3)]


def arguments(recordings: list[str]) -> list[str]:
    vehicle = recordings[0].replace(".sigmf-meta", ".vehicle.csv")
    return ["array", *recordings, "--elements", ELEMENTS, "--vehicle", vehicle]


def test_the_counterfeit_is_told_from_the_satellites(recordings: list[str], tmp_path: Path) -> None:
    out = tmp_path / "report"
    more = ("--nav", str(DEFAULT), "--lines", "0,0", "-o", str(out), "--json")
    done = run(*arguments(recordings), *more)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["orbits_known"]
    verdicts = {s["satellite"]: s["verdict"] for s in told["satellites"]}
    assert verdicts == {"G11": "spoofed"} | dict.fromkeys(("G06", "G17", "G19", "G20"), "clean")
    assert (out / "array.png").read_bytes().startswith(b"\x89PNG")
    rows = (out / "array.csv").read_text().splitlines()
    assert rows[0] == "satellite,signal,time_s,way_m,score,p_value,threshold,test"
    assert len(rows) - 1 == sum(s["tests"] + s["arrivals"] for s in told["satellites"])
    report = (out / "report.html").read_text()
    assert "G11 L1CA does not come from its satellite" in report
    assert "did not come from where the satellite is" in report


def test_mistakes_are_named(
    recordings: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def message(*words: str) -> str:
        return " ".join(failing(capsys, *words)[1].split())

    good = arguments(recordings)
    assert "--vehicle: missing" in message(*good[:-2])
    assert "one line" in message(*good, "--elements", "0,0,0;1,0,0;2,0,0")
    assert "--elements" in message(*good, "--elements", "0,0;x")
    assert "--lines: directions of arrival need" in message(*good, "--lines", "0,0")
    assert "1 calibrated lines" in message(*good, "--lines", "0")
    assert "is not a number of m" in message(*good, "--lines", "0,x")
    assert "2 recordings for an array of 3" in message(
        "array", *recordings[:2], "--elements", ELEMENTS, "--vehicle", good[-1]
    )
    level = tmp_path / "level.csv"
    level.write_text("time_s,x_m,y_m,z_m\n" + "\n".join(f"{t},6378137,{t},0" for t in range(12)))
    assert "yaw_deg" in message(*good, "--vehicle", str(level))
    late = tmp_path / "late.csv"
    header = "time_s,x_m,y_m,z_m,yaw_deg,pitch_deg,roll_deg\n"
    late.write_text(header + "\n".join(f"{900 + t},6378137,{t},0,0,0,0" for t in range(12)))
    assert "do not overlap" in message(*good, "--vehicle", str(late))
