"""``sdr-spoof aid`` on files in closed form: a ship, three of its satellites dragged."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import observed_sky as sky
import pytest

from sdr_spoof.aided.session import Session
from sdr_spoof.aiding.imu.errors import read
from sdr_spoof.aiding.imu.grades import draw
from sdr_spoof.aiding.imu.readers import table
from sdr_spoof.aiding.imu.simulate import ideal_increments
from sdr_spoof.cli import main
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory
from sdr_spoof.sinks.rinex_obs import write_rinex_obs

LENGTH_S = 130
TIME = np.arange(float(LENGTH_S))
ORIGIN = np.array([39.9, 116.4, 60.0])
NAV = sky.VECTORS / "brd4_2023071_04h_08h.rnx"
AS_IN_CLOSED_FORM = ("--pvt-ionosphere", "none", "--pvt-troposphere", "none")
QUICK = ("--tight-settle-s", "30", "--grade", "ship-a")


def way(time_s):
    return np.stack([8 * time_s, 60 * np.sin(time_s / 30), 0.5 * np.sin(time_s / 3)], axis=1)


SHIP = Trajectory(OnPlane(ORIGIN, way))


def observed():
    """The attacked, and the names of the three."""
    clock = 3e4 + 20 * TIME
    at = TIME - clock / sky.LIGHT
    made = sky.Sky(
        epochs=LENGTH_S,
        track=SHIP.position_m(at),
        track_velocity=SHIP.velocity_m_s(at),
        clock_m=clock,
        drift_m_s=np.full(LENGTH_S, 20.0),
        sigma_m=1.0,
        rate_sigma_m_s=0.03,
        satellites=11,
    ).observe()
    hit = [1, 4, 7]
    pull = 2.0 * np.clip(TIME - 80, 0, None)
    wavelength = sky.LIGHT / 1561.098e6
    ranges, phases, dopplers = (
        x.copy() for x in (made.pseudorange_m, made.carrier_phase_cycles, made.doppler_hz)
    )
    ranges[:, hit] += pull[:, None]
    phases[:, hit] += pull[:, None] / wavelength
    dopplers[80:, hit] -= 2.0 / wavelength
    seen = dataclasses.replace(
        made, pseudorange_m=ranges, carrier_phase_cycles=phases, doppler_hz=dopplers
    )
    return seen, [made.satellites[k] for k in hit]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ship")
    seen, names = observed()
    write_rinex_obs(folder / "ship.rnx", seen)
    ideal = ideal_increments(SHIP, LENGTH_S, 100.0, reference=sky.START)
    table.write(folder / "ship.imu.csv", read(ideal, draw("ship-a", 1)[0]).log)
    return folder, names


def aid(files, *more, observations="ship.rnx", imu="ship.imu.csv", nav=NAV):
    folder = files[0]
    words = ["aid", str(folder / observations), "--imu", str(folder / imu)]
    words += ["--nav", str(nav)] if nav else []
    return main([*words, *QUICK, *AS_IN_CLOSED_FORM, *map(str, more)])


def failing(capsys, code):
    output = capsys.readouterr()
    assert code != 0 and output.out == "" and "Traceback" not in output.err
    return " ".join(output.err.split())


def test_three_satellites_are_named(files, tmp_path, capsys):
    folder, names = files
    out = tmp_path / "out"
    assert aid(files, "-o", out, "--attitude", heading(), "--smooth", "--json") == 0
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


def heading() -> str:
    yaw = np.degrees(SHIP.attitude_rad(np.zeros(1)))[0, 0]
    return f"{yaw:.3f},0,0"


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
    assert "no truth of a scenario" in failing(capsys, aid(files, *out, "--truth", NAV))
    assert "no IMU grade 'gold'" in failing(capsys, aid(files, *out, "--grade", "gold"))
    assert not (tmp_path / "out").exists()


def test_help_has_examples(capsys):
    with pytest.raises(SystemExit):
        main(["aid", "--help"])
    said = capsys.readouterr().out
    assert "--imu FILE" in said and "examples:" in said and "--tight-states" in said
