"""What a perfect IMU senses along trajectories."""

import math
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.errors import ConfigError
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.scenario.sky.receiver import AnyReceiver
from sdr_spoof.scenario.sky.trajectory import Trajectory

PLACE = {"latitude_deg": 31.2, "longitude_deg": 121.5, "height_m": 20.0}
EARTH_RAD_S = 7.292115e-5


def made(duration_s: float = 60.0, **table: object) -> Trajectory:
    return TypeAdapter(AnyReceiver).validate_python(table).trajectory(duration_s)


def test_at_rest_it_senses_gravity_and_the_earth() -> None:
    log = ideal_increments(made(kind="static", **PLACE), 1.0, 50.0)
    assert log.time_s == pytest.approx(np.arange(1, 51) / 50)
    north, down = math.cos(math.radians(31.2)), -math.sin(math.radians(31.2))
    turn = np.array([north, 0.0, down]) * EARTH_RAD_S / 50
    assert log.rotation_rad == pytest.approx(np.tile(turn, (50, 1)), abs=1e-15)
    # Normal gravity of WGS 84 at 31.2 degrees and 20 m, by Somigliana's formula.
    assert log.velocity_m_s[:, 2] * -50 == pytest.approx(np.full(50, 9.794135), abs=2e-6)
    assert log.velocity_m_s[:, :2] == pytest.approx(np.zeros((50, 2)), abs=1e-12)


def test_on_a_circle_it_senses_the_turn() -> None:
    t = made(kind="circle", radius_m=91.8, speed_m_s=30.0, **PLACE)
    log = ideal_increments(t, 10.0, 100.0)
    rate = 30.0 / 91.8
    # Clockwise: to the right, with the axis down; the Earth's own rotation comes on top.
    turned = log.rotation_rad[:, 2].sum() / 10.0
    assert turned == pytest.approx(rate - EARTH_RAD_S * math.sin(math.radians(31.2)), rel=2e-6)
    assert log.velocity_m_s[:, 1] * 100 == pytest.approx(np.full(1000, 900 / 91.8), rel=1e-3)


def test_rates_and_starts_cut_the_same_motion() -> None:
    t = made(60.0, kind="vehicle", seed=1, stand_s=0.0, **PLACE)
    fine = ideal_increments(t, 20.0, 200.0, start_s=10.0)
    coarse = ideal_increments(t, 30.0, 50.0)
    assert coarse.time_s[500] == pytest.approx(fine.time_s[3], abs=1e-12)
    sums = fine.velocity_m_s.reshape(-1, 4, 3).sum(axis=1)
    assert coarse.velocity_m_s[500:] == pytest.approx(sums, abs=1e-5)
    assert np.abs((coarse.velocity_m_s[500:] - sums).sum(axis=0)).max() < 1e-6
    turns = fine.rotation_rad.reshape(-1, 4, 3).sum(axis=1)
    assert coarse.rotation_rad[500:] == pytest.approx(turns, abs=1e-6)


def test_a_file_across_the_date_line(tmp_path: Path) -> None:
    path = tmp_path / "way.csv"
    rows = [f"{k},10.0,{(180 + 1e-4 * (k - 10) + 180) % 360 - 180},0,90,0,0" for k in range(21)]
    header = "time_s,latitude_deg,longitude_deg,height_m,yaw_deg,pitch_deg,roll_deg"
    path.write_text("\n".join([header, *rows]))
    log = ideal_increments(made(20.0, kind="csv", file=str(path)), 20.0, 100.0)
    # Evenly to the east: gravity, less what Eotvoes' effect of 11 m/s takes off.
    assert log.velocity_m_s[:, 2] * 100 == pytest.approx(np.full(2000, -9.7800), abs=3e-3)


def test_an_attitude_that_jumps_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "way.csv"
    place = geodetic_to_ecef([31.2, 121.5, 20.0])
    gone = [max(0.0, k - 10.0) for k in range(21)]
    rows = [f"{k},{place[0] + g},{place[1]},{place[2]}" for k, g in enumerate(gone)]
    path.write_text("\n".join(["time_s,x_m,y_m,z_m", *rows]))
    with pytest.raises(ConfigError, match=r"jumps by .* degrees at .* s.*give yaw_deg"):
        ideal_increments(made(20.0, kind="csv", file=str(path)), 20.0, 100.0)


def test_true_states_are_of_the_body() -> None:
    t = made(kind="circle", radius_m=91.8, speed_m_s=30.0, lever_arm_m=(2.0, 0.0, -1.0), **PLACE)
    states = true_states(t, np.array([0.0, 1.0]))
    away = t.position_m(states.time_s) - states.position_m
    assert np.linalg.norm(away, axis=1) == pytest.approx(np.full(2, math.sqrt(5)))
    speed = np.linalg.norm(states.velocity_m_s, axis=1)
    assert speed == pytest.approx(np.full(2, 30.0), rel=1e-4)


@pytest.mark.parametrize("mechanisation", ["local", "earth-fixed"])
@pytest.mark.parametrize(
    "receiver",
    [
        {"kind": "vehicle", "seed": 3, **PLACE},
        {"kind": "uav", "seed": 3},
        {"kind": "ship", "seed": 3, "sea_state": 6, **PLACE},
        {"kind": "circle", "radius_m": 500.0, "speed_m_s": 20.0, **PLACE},
    ],
    ids=lambda r: str(r["kind"]),
)
def test_a_strapdown_computer_comes_back_to_the_trajectory(
    receiver: dict[str, object], mechanisation: strapdown.Mechanisation
) -> None:
    """Half an hour at 100 Hz: the limits are those of the study of pseudorange rates."""
    t = made(1750.0, **receiver)
    log = ideal_increments(t, 1750.0, 100.0)
    truth = true_states(t, np.array([0.0, 1750.0]))
    got = strapdown.navigate(
        log, strapdown.row(truth, 0), every=len(log.time_s), mechanisation=mechanisation
    )
    assert np.linalg.norm(got.position_m[-1] - truth.position_m[-1]) < 0.05
    assert np.linalg.norm(got.velocity_m_s[-1] - truth.velocity_m_s[-1]) < 1e-4
    turned = got.attitude_rad[-1] - truth.attitude_rad[-1]
    assert np.abs(np.angle(np.exp(1j * turned))).max() < 1e-7
