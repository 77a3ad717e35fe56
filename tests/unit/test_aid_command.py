"""``sdr-spoof aid`` on files in closed form: a ship, three of its satellites dragged."""

from __future__ import annotations

import json

import aid_files as ship
import pytest

from sdr_spoof.aided.session import Session
from sdr_spoof.aiding.imu.readers import table
from sdr_spoof.cli import main
from sdr_spoof.sinks.rinex_obs import write_rinex_obs


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ship")
    seen, names = ship.attacked()
    write_rinex_obs(folder / "ship.rnx", seen)
    table.write(folder / "ship.imu.csv", ship.increments())
    return folder, names


def aid(files, *more, observations="ship.rnx", imu="ship.imu.csv", nav=ship.NAV):
    return ship.aid(files[0] / observations, files[0] / imu, *more, nav=nav)


def failing(capsys, code):
    output = capsys.readouterr()
    assert code != 0 and output.out == "" and "Traceback" not in output.err
    return " ".join(output.err.split())


def test_three_satellites_are_named(files, tmp_path, capsys):
    folder, names = files
    out = tmp_path / "out"
    assert aid(files, "-o", out, "--attitude", ship.heading(), "--smooth", "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert data["config"]["tight"]["smooth"] is True
    assert "smoothed_latitude_deg" in (out / "aided.csv").read_text().splitlines()[0]
    assert data["verdict"]["verdict"] == "spoofed"
    assert data["verdict"]["satellites"] == names
    assert 75 < data["verdict"]["onset_s"] < 85
    assert data["start_utc"].startswith("2023-03-12 05:59:42")
    assert sorted(p.name for p in out.iterdir()) == ["aided.csv", "aided.h5", "aided.html"]
    assert all(name in data["left_out"] for name in names)
    # Not again without --force, and said before anything runs.
    message = failing(capsys, aid(files, "-o", out))
    assert "exists already; add --force" in message
    del folder


def test_the_answer_in_words(files, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(Session, "write", lambda *_, **__: None)
    assert aid(files, "-o", tmp_path / "out") == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "Spoofing detected" in said and f"leave {', '.join(files[1])} out" in said
    assert "Severity: GNSS alone was led" in said


def test_mistakes(files, tmp_path, capsys):
    folder, _ = files
    out = ("-o", tmp_path / "out")
    assert "there are no orbits" in failing(capsys, aid(files, *out, nav=None))
    assert "does not exist" in failing(capsys, aid(files, *out, observations="none.rnx"))
    assert "none.csv" in failing(capsys, aid(files, *out, imu="none.csv"))
    lines = (folder / "ship.imu.csv").read_text().splitlines()
    late = [lines[0]] + [f"2254{line[4:]}" for line in lines[1:]]
    (folder / "late.csv").write_text("\n".join(late))
    message = failing(capsys, aid(files, *out, imu="late.csv"))
    assert "IMU and GNSS have nothing in common: the IMU covers 2023-03-19" in message
    assert "no truth of a scenario" in failing(capsys, aid(files, *out, "--truth", ship.NAV))
    assert "no IMU grade 'gold'" in failing(capsys, aid(files, *out, "--grade", "gold"))
    assert not (tmp_path / "out").exists()


def test_help_has_examples(capsys):
    with pytest.raises(SystemExit):
        main(["aid", "--help"])
    said = capsys.readouterr().out
    assert "--imu FILE" in said and "examples:" in said and "--tight-states" in said
