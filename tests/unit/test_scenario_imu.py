"""IMUs of scenarios: the table, the file beside the recording, the truth."""

import json
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError
from skies import PLACE, RECORDING, VACUUM

from sdr_spoof.aiding.imu.config import ImuConfig
from sdr_spoof.aiding.imu.grades import DEG_HOUR, MICRO_G
from sdr_spoof.aiding.imu.readers import read_imu
from sdr_spoof.aiding.imu.simulate import ideal_increments
from sdr_spoof.errors import ConfigError, OutputError
from sdr_spoof.scenario import Scenario, builtin_scenario, imu_of, imu_path, synthesize, truth_path

SHIP = PLACE | {"kind": "ship", "lever_arm_m": [1.0, 0.5, -8.0]}
SMALL = {"duration_s": 0.5, "sample_rate_hz": 4.2e6, "lo_hz": 1561.098e6, "sample_format": "c2"}


def made(imu: dict, receiver: dict | None = None, **recording: object) -> Scenario:
    sky = {"start": "2023-03-12T12:00:00", "receiver": receiver or SHIP, "signals": ["B1I"]}
    return Scenario.model_validate(
        {"recording": RECORDING | SMALL | recording, "sky": sky | VACUUM, "imu": imu}
    )


def test_a_perfect_one_reads_the_truth():
    scenario = made({}, duration_s=3.0)
    imu = imu_of(scenario)
    ideal = ideal_increments(scenario.sky_model().trajectory, 3.0, 100.0)
    np.testing.assert_array_equal(imu.log.rotation_rad, ideal.rotation_rad)
    assert imu.log.reference == scenario.sky.start_time
    np.testing.assert_allclose(imu.log.time_s, np.arange(1, 301) / 100)


def test_grade_and_what_differs_from_it():
    table = {
        "grade": "tactical",
        "gyro": {"bias_deg_h": [1.0, -2.0, 3.0], "step_arcsec": 0.1, "wander_deg_h": 0.5},
        "accelerometer": {"range_g": 10.0, "scale_ppm": [100.0, 0.0, 0.0]},
    }
    errors = made(table | {"seed": 4}).imu.errors(9)
    grade = made({"grade": "tactical"}).imu.errors(4)
    assert errors.seed == 4
    assert errors.gyro.bias == pytest.approx([DEG_HOUR, -2 * DEG_HOUR, 3 * DEG_HOUR])
    assert errors.gyro.quantum == pytest.approx(np.radians(0.1 / 3600))
    assert errors.gyro.wander == pytest.approx(0.5 * DEG_HOUR)
    assert errors.gyro.density == grade.gyro.density
    assert errors.accelerometer.bias == grade.accelerometer.bias
    assert errors.accelerometer.limit == pytest.approx(98.0665)
    assert errors.accelerometer.scale == pytest.approx((1e-4, 0.0, 0.0))
    explicit = made({"accelerometer": {"bias_ug": [10.0, 0.0, 0.0]}}).imu.errors(9)
    assert explicit.accelerometer.bias == pytest.approx((10 * MICRO_G, 0.0, 0.0))
    assert explicit.gyro.density == 0.0


def test_one_scenario_gives_samples_and_increments_and_truth(tmp_path: Path):
    scenario = made({"grade": "ship-a", "clock_offset_s": 0.25})
    meta = synthesize(scenario, tmp_path / "rec")
    path = imu_path(meta)
    assert path == tmp_path / "rec.imu.csv" == imu_path(tmp_path / "rec.bin")
    got = read_imu(path, ImuConfig(clock_offset_s=0.25, checks=False)).log
    expected = imu_of(scenario).readings.log
    late_s = got.reference - scenario.sky.start_time
    assert late_s + got.time_s == pytest.approx(expected.time_s, abs=2e-9)
    assert got.rotation_rad == pytest.approx(expected.rotation_rad, rel=1e-11)
    truth = json.loads(truth_path(meta).read_text())["imu"]
    assert truth["lever_arm_m"] == [1.0, 0.5, -8.0]
    assert np.shape(truth["attitude_deg"]) == (6, 3)
    assert abs(np.array(truth["gyro_bias_rad_s"])) == pytest.approx(np.full((6, 3), 0.1 * DEG_HOUR))
    with pytest.raises(OutputError, match="exists already"):
        synthesize(scenario, tmp_path / "rec")


def test_the_truth_is_of_the_imu_and_not_of_the_antenna():
    scenario = made({})
    time_s = np.arange(6) / 10
    truth = imu_of(scenario).truth(time_s)
    sky = scenario.sky_model()
    away = sky.trajectory.position_m(time_s) - np.array(truth["position_m"])
    assert np.linalg.norm(away, axis=1) == pytest.approx(np.full(6, 65.25**0.5), abs=1e-4)
    assert truth["start"]["attitude_deg"] == truth["attitude_deg"][0]
    json.dumps(truth, allow_nan=False)


def test_biases_of_the_truth_wander():
    scenario = made({"grade": "mems"}, duration_s=30.0)
    imu = imu_of(scenario)
    truth = imu.truth(np.arange(300) / 10)
    assert np.std(truth["gyro_bias_rad_s"], axis=0).min() > 0
    assert truth["gyro_bias_rad_s"][10] == imu.readings.gyro_bias_rad_s[99].tolist()


def test_it_stands_still_before():
    car = PLACE | {"kind": "vehicle", "seed": 2}
    imu = imu_of(made({"still_s": 20.0}, car, duration_s=12.0))
    assert imu.log.time_s[[0, -1]] == pytest.approx([-19.99, 12.0])
    assert imu.log.velocity_m_s[:2000, 2] == pytest.approx(np.full(2000, -0.0979), abs=1e-4)
    assert np.ptp(imu.log.rotation_rad[:2500, 2]) < 1e-9
    truth = imu.truth(np.arange(10) / 10)
    assert truth["start"]["time_s"] == pytest.approx(-20.0)
    assert np.linalg.norm(truth["start"]["velocity_m_s"]) < 1e-6
    with pytest.raises(ConfigError, match=r"still_s: the receiver moves at 8 m/s"):
        imu_of(made({"still_s": 20.0}))


def test_it_begins_late():
    imu = imu_of(made({"start_s": 1.0}, duration_s=3.0))
    assert imu.log.time_s[[0, -1]] == pytest.approx([1.01, 3.0])


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"grade": "best"}, "unknown grade 'best'; known: navigation"),
        ({"rate_hz": 10.0}, "greater than or equal to 50"),
        ({"start_s": 1.0, "still_s": 5.0}, "both before the recording and after"),
        ({"start_s": 1.0}, "is not before the end of the recording at 0.5 s"),
    ],
)
def test_mistakes(table, message):
    with pytest.raises(ValidationError, match=message):
        made(table)


def test_without_a_sky_there_is_no_motion():
    with pytest.raises(ValidationError, match=r"\[imu\] needs a \[sky\]"):
        Scenario.model_validate({"recording": RECORDING, "imu": {}})


@pytest.mark.parametrize("name", ["ship-spoofed", "ship-quick"])
def test_the_ships_that_come_with_the_package(name):
    scenario = builtin_scenario(name)
    assert len(scenario.satellites) == 10
    (attack,) = scenario.attack
    assert {s.prn for s, _ in scenario.victims(0)} == {7, 20, 40}
    spoofed_s = scenario.recording.duration_s - attack.drag_start_s
    assert spoofed_s >= (120.0 if name == "ship-spoofed" else 15.0)
    imu = imu_of(scenario)
    assert imu.log.time_s.size == 100 * scenario.recording.duration_s
    assert scenario.recording.sample_count * scenario.recording.bits_per_sample < 8 * 0.7e9
