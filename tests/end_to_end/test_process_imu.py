"""``process --imu``: from samples of a ship and its IMU to the aided verdict."""

from __future__ import annotations

import io
import json
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from commands import failing

from sdr_spoof import pipeline, simulate
from sdr_spoof.aided.session import Session
from sdr_spoof.cli import main

BROADCAST = Path(simulate.__code__.co_filename).parent / "scenario/data/brdc-2023-03-12.rnx"
TIME, PLACE = "2023-03-12T12:00:00", "31.2,121.9,15"
SILENT = "".join(
    f"[[sky.satellite]]\nprn = {prn}\non_air = false\n"
    for prn in (1, 2, 3, 4, 10, 59, 60, 29, 38, 40)
)
SEA = f"""
[recording]
duration_s = 26.0
sample_rate_hz = 4.2e6
lo_hz = 1561.098e6
sample_format = "c2"
bandwidth_hz = 4.0e6
seed = 62
[sky]
start = "{TIME}"
systems = ["C"]
signals = ["B1I"]
elevation_mask_deg = 15.0
[sky.clock]
offset_us = 20.0
drift_ppb = 40.0
h0 = 2e-21
h_2 = 2.2e-22
[sky.receiver]
kind = "ship"
latitude_deg = 31.2
longitude_deg = 121.9
height_m = 15.0
seed = 5
sea_state = 4
lever_arm_m = [-6.0, 1.5, -12.0]
{SILENT}
[imu]
grade = "ship-a"
"""
REAL_PROCESS = pipeline.process


@dataclass(frozen=True)
class Sea:
    """A recording, and what its processing has said."""

    folder: Path
    attitude: str
    """At the first epoch, 1 s."""
    said: dict
    processed: pipeline.Processed | None

    def words(self, imu: Path, *more: str) -> list[str]:
        """Flags that process and aid share; the filter settles in 15 s here."""
        known = ["--imu", imu, "--grade", "ship-a", f"--attitude={self.attitude}"]
        known += ["--tight-settle-s", "15", "--aided-min-tested-s", "5", "--json", *more]
        return [str(word) for word in known]

    def processing(self, imu: str, *more: str) -> list[str]:
        """The whole command, from a hot start."""
        hot = ["--navigation-files", BROADCAST, "--navigation-time", TIME]
        hot += ["--navigation-place", PLACE, "-o", self.folder / "out", *more]
        words = ["process", self.folder / "sea.bin.toml", *hot]
        return [*map(str, words), *self.words(self.folder / imu)]


@pytest.fixture(scope="module")
def sea(tmp_path_factory) -> Sea:
    folder = tmp_path_factory.mktemp("sea")
    (folder / "sea.toml").write_text(SEA)
    with redirect_stdout(io.StringIO()):
        assert main(["synth", str(folder / "sea.toml"), "-o", str(folder / "sea")]) == 0
    truth = json.loads((folder / "sea.truth.json").read_text())
    row = int(np.argmin(np.abs(np.array(truth["time_s"]) - 1.0)))
    attitude = ",".join(f"{v:.4f}" for v in truth["imu"]["attitude_deg"][row])
    made = Sea(folder, attitude, {}, None)
    kept: list[pipeline.Processed] = []

    def process(*words, **named):
        kept.append(REAL_PROCESS(*words, **named))
        return kept[-1]

    with redirect_stdout(io.StringIO()) as text, pytest.MonkeyPatch.context() as patch:
        patch.setattr(pipeline, "process", process)
        assert main(made.processing("sea.imu.csv")) == 0
    return Sea(folder, attitude, json.loads(text.getvalue()), kept[0])


def test_from_samples_to_the_aided_verdict(sea):
    said = sea.said["aided"]
    assert said["verdict"]["verdict"] == "clean"
    assert said["verdict"]["doubt"] == ""
    assert said["config"]["imu"]["lever_arm_m"] == [-6.0, 1.5, -12.0]
    assert (
        "lever arm of -6,1.5,-12 m (forward, right, down), as the IMU's file says"
        in (said["verdict"]["notes"])
    )
    assert {s["verdict"] for s in sea.said["verdict"]["satellites"]} == {"clean"}
    found = {path.name for path in (sea.folder / "out").iterdir()}
    assert found == {"report.html", "result.h5", "aided.html", "aided.h5", "aided.csv"}


@pytest.fixture
def aid(sea, capsys, monkeypatch, tmp_path):
    """The verdict of ``aid`` on the result file, with other flags; figures are left out."""
    monkeypatch.setattr(Session, "write", lambda *_, **__: None)

    def run(imu: Path, *more: str) -> dict:
        words = ["aid", sea.folder / "out/result.h5", "-o", tmp_path / "out"]
        words += ["--nav", BROADCAST, "--truth", sea.folder / "sea.truth.json"]
        assert main([*map(str, words), *sea.words(imu), *more]) == 0
        return json.loads(capsys.readouterr().out)

    return run


def test_the_result_file_gives_the_same(sea, aid):
    again = aid(sea.folder / "sea.imu.csv")
    assert again["verdict"] == sea.said["aided"]["verdict"]
    assert again["error_m"]["aided"] < 5.0


@pytest.mark.parametrize("arm", ["-6,1.5,1", "0,0,0"])
def test_a_wrong_lever_arm_is_told(sea, aid, arm):
    """13 m off, it looks like spoofing of all satellites."""
    said = aid(sea.folder / "sea.imu.csv", f"--lever-arm={arm}")["verdict"]
    assert said["verdict"] == "suspect"
    assert f"not as at the lever arm of {arm} m" in said["doubt"]
    assert "1.4 ± 0.1, -12.0 ± 0.0 m" in said["doubt"] and said["doubt"] in said["reason"]
    told = f"the lever arm given, {arm} m, is used; the IMU's file says -6,1.5,-12 m"
    assert told in said["notes"]


def test_a_lever_arm_that_nobody_tells(sea, aid, tmp_path):
    text = (sea.folder / "sea.imu.csv").read_text()
    bare = tmp_path / "bare.csv"
    bare.write_text(text.partition("\n")[2])
    said = aid(bare)["verdict"]
    assert said["verdict"] == "suspect"
    assert any("no lever arm is known (--lever-arm)" in note for note in said["notes"])
    assert "not as at the lever arm of 0,0,0 m" in said["doubt"]


def test_without_the_file_nothing_is_begun(sea, capsys, monkeypatch):
    monkeypatch.setattr(pipeline, "process", None)
    message = failing(capsys, *sea.processing("none.csv", "--force"))[1]
    assert "none.csv: cannot be read: No such file" in message


def test_clocks_that_do_not_overlap(sea, capsys, monkeypatch):
    """The receiver's own results stay, and the message says where."""
    lines = (sea.folder / "sea.imu.csv").read_text().splitlines()
    late = [*lines[:2], *(f"2254{line[4:]}" for line in lines[2:])]
    (sea.folder / "late.csv").write_text("\n".join(late))
    monkeypatch.setattr(pipeline, "process", lambda *_, **__: sea.processed)
    message = " ".join(failing(capsys, *sea.processing("late.csv", "--force"))[1].split())
    assert "IMU and GNSS have nothing in common: the IMU covers 2023-03-19" in message
    assert "what the receiver itself found is in" in message and "report.html" in message
