"""``sdr-spoof aid`` on a clean drive whose IMU is wrong: refused, or said, but never 'spoofed'."""

from __future__ import annotations

import dataclasses
import json

import aid_files as ship
import numpy as np
import pytest

from sdr_spoof.aided.session import Session
from sdr_spoof.aiding.imu.readers import table
from sdr_spoof.sinks.rinex_obs import write_rinex_obs

LOG = ship.increments()
TIME = LOG.time_s
SWAP = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, 1]])
QUARTER = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
DIFFERENT = "IMU and GNSS tell of different motions"
TILTED = "roll and pitch at 1 s seem to be off by"


def without(first_s, last_s):
    keep = (first_s >= TIME) | (last_s <= TIME)
    return dataclasses.replace(
        LOG,
        time_s=TIME[keep],
        rotation_rad=LOG.rotation_rad[keep],
        velocity_m_s=LOG.velocity_m_s[keep],
    )


def timed(time_s):
    return dataclasses.replace(LOG, time_s=time_s)


def sensed(gyro=1.0, accel=1.0):
    """Increments times a factor, one an axis, or through a matrix."""
    rotation, velocity = (
        v @ m if np.ndim(m) == 2 else v * m
        for v, m in ((LOG.rotation_rad, gyro), (LOG.velocity_m_s, accel))
    )
    return dataclasses.replace(LOG, rotation_rad=rotation, velocity_m_s=velocity)


def forced(value, first=5000, last=5003):
    """Some rows of one accelerometer."""
    velocity = LOG.velocity_m_s.copy()
    velocity[first:last, 0] = value
    return dataclasses.replace(LOG, velocity_m_s=velocity)


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    path = tmp_path_factory.mktemp("bad_imu") / "clean.rnx"
    write_rinex_obs(path, ship.clean())
    return path


@pytest.fixture
def aid(drive, tmp_path, capsys, monkeypatch):
    """Exit code, verdict, message."""
    monkeypatch.setattr(Session, "write", lambda *_, **__: None)

    def run(log, *more):
        table.write(tmp_path / "imu.csv", log)
        words = ["-o", tmp_path / "out", "--json", "--attitude", ship.heading(), *more]
        code = ship.aid(drive, tmp_path / "imu.csv", *words)
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        assert (code == 0) == bool(said.out)
        verdict = json.loads(said.out)["verdict"] if said.out else None
        return code, verdict, " ".join(said.err.split())

    return run


@pytest.mark.parametrize(
    ("log", "note"),
    [
        (LOG, None),
        (without(60.0, 60.06), "a gap of 0.05 s at 60.00 s: up to 0.1 s is bridged"),
        (without(60.0, 60.51), "a gap of 0.5 s at 60.00 s"),
        (without(60.0, 65.0), "a gap of 4.99 s"),
        (without(60.0, 125.0), "a gap of 65 s"),
        (forced(0.5), "accelerometer x is at the end of its range in 3 rows, first at 50.01 s"),
        (timed(TIME + 0.01), None),
        (sensed(SWAP.T @ SWAP), None),
    ],
)
def test_what_does_no_harm(aid, log, note):
    code, verdict, _ = aid(log)
    assert code == 0 and verdict["verdict"] == "clean" and verdict["doubt"] == ""
    assert note is None or any(note in n for n in verdict["notes"])


@pytest.mark.parametrize(
    ("log", "doubt"),
    [
        (timed(TIME + 0.5), "the IMU's clock seems to be off by +0.5"),
        (timed(TIME - 18.0), "against GNSS, or in another time system"),
        (
            timed(TIME + 0.5 * (TIME > 60)),
            "after the gap of the IMU at 60.5 s the IMU's clock seems to be off by +0.",
        ),
        (
            timed(TIME + 5.0 * (TIME > 60)),
            "comes soon after a gap of the IMU at 65.0 s: has its clock jumped there?",
        ),
        (sensed(gyro=SWAP), DIFFERENT),
        (sensed(accel=SWAP), DIFFERENT),
        (sensed(QUARTER, QUARTER), DIFFERENT),
        (sensed(gyro=np.array([1.0, 1, -1])), DIFFERENT),
        (sensed(gyro=1 / 57.3), DIFFERENT),
        (sensed(gyro=57.3), TILTED),
    ],
)
def test_what_would_look_like_spoofing(aid, log, doubt):
    """So little motion that the file alone does not tell."""
    code, verdict, _ = aid(log)
    assert code == 0 and verdict["verdict"] == "suspect"
    assert doubt in verdict["doubt"] and verdict["doubt"] in verdict["reason"]
    assert verdict["doubt"] in verdict["notes"]


def test_a_wrong_attitude_at_the_start(aid):
    _, verdict, _ = aid(LOG, f"--attitude={ship.heading().replace(',0,0', ',0,1.5')}")
    assert verdict["verdict"] == "suspect"
    assert "roll and pitch at 1 s seem to be off by 1." in verdict["doubt"]


@pytest.mark.parametrize(
    ("log", "why"),
    [
        (timed(TIME - 0.5 * (TIME > 60)), "0.49 s before the row above; sort the rows, or split"),
        (forced(0.5, 5000, 5050), "is at the end of its range for 0.50 s at 50.01 s"),
        (
            forced(np.nan),
            "3 of 13000 rows are not numbers, the first is row 5001 (accel",
        ),
        (sensed(np.array([1.0, -1, -1]), np.array([1.0, -1, -1])), "give axes = FLU"),
        (sensed(accel=1 / 9.80665), "the values look like g_s: name the columns accel_x_g_s"),
        (timed(TIME - 8 * 3600.0), "is one of them in local time?"),
        (timed(TIME - 150.0), "is one of them in UTC, which is 18 s behind GPST?"),
        (timed(TIME + 7 * 86400.0), "nothing in common: the IMU covers 2023-03-19"),
    ],
)
def test_what_is_refused(aid, log, why):
    code, verdict, message = aid(log)
    assert code == 1 and verdict is None and why in message


def test_no_file(drive, tmp_path, capsys):
    assert ship.aid(drive, tmp_path / "none.csv", "-o", tmp_path / "out") == 1
    assert "none.csv: cannot be read: No such file" in capsys.readouterr().err
    (tmp_path / "empty.csv").write_text("")
    assert ship.aid(drive, tmp_path / "empty.csv", "-o", tmp_path / "out") == 1
    assert "is no file of an IMU that is known" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
