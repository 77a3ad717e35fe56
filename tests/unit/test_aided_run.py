"""From simulated measurements and increments to a verdict."""

from __future__ import annotations

import dataclasses

import aided_ship as ship
import numpy as np
import pytest

from sdr_spoof.aided.records import Guard, Use
from sdr_spoof.aided.run import aid, with_hardware
from sdr_spoof.aided.start import begin
from sdr_spoof.aiding import simulated as sim
from sdr_spoof.aiding.imu.errors import read
from sdr_spoof.aiding.imu.grades import draw
from sdr_spoof.aiding.imu.simulate import ideal_increments
from sdr_spoof.aiding.tight import TightConfig
from sdr_spoof.errors import AidingError, ConfigError
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory

THREE = sim.velocity_drag((1.0, 0.0, 0.0), 80.0, 120.0, satellites=ship.ATTACKED)
ALL = sim.velocity_drag((1.0, 0.0, 0.0), 80.0, 120.0)


def test_three_satellites_are_named_and_left_out():
    found = aid(ship.measured(THREE), ship.increments(), ship.config())
    verdict = found.verdict
    assert verdict.verdict == "spoofed" and not verdict.everybody
    assert verdict.satellites == ship.ATTACKED
    assert 78.0 <= verdict.onset_s <= 84.0 and 80.0 <= verdict.alarm_s <= 84.0
    assert verdict.confidence > 0.999999
    track = found.track
    # Back at a copy that is barely older than the start, it coasts worse than after minutes.
    assert ship.error_m(track)[5:].max() < 12.0 and ship.error_m(track)[95:].max() < 5.0
    after = (ship.TIME > 95) & (ship.TIME < 119)
    assert (track.use[after][:, [1, 4, 7]] == Use.EXCLUDED).all()
    assert (track.use[after][:, [0, 2, 3, 5, 6, 8, 9]] == Use.USED).all()
    assert (track.guard[after] == Guard.PARTIAL).all()
    assert any("C02, C05, C08" in line for line in found.story)
    assert "R over 1 of" in found.three_way


def test_all_satellites_are_disbelieved_together():
    found = aid(ship.measured(ALL), ship.increments(), ship.config())
    assert found.verdict.verdict == "spoofed" and not found.verdict.satellites
    assert found.verdict.severity_m > 30.0
    inside = (ship.TIME > 85) & (ship.TIME < 120)
    assert (found.track.use[inside] == Use.EXCLUDED).all()
    away = np.linalg.norm(found.track.alone_m - ship.SHIP.position_m(ship.TIME), axis=1)
    assert away[119] > 35.0 and ship.error_m(found.track)[119] < 16.0
    # What is told of the error is not below it.
    level = np.hypot(found.track.horizontal_m, found.track.vertical_m)
    assert (ship.error_m(found.track) < level).all()


def test_nothing_is_found_in_clean_measurements():
    found = aid(ship.measured(), ship.increments(), ship.config())
    assert found.verdict.verdict == "clean" and len(found.story) == 1
    assert found.verdict.tested_s > 60
    assert [m.name for m in found.residuals] == ["east", "north", "up"]
    assert found.three_way == "no statistic R over 1"
    assert ship.error_m(found.track)[5:].max() < 5.0


def test_what_the_receiver_calls_spoofed_is_left_out_by_its_word():
    clean = ship.measured()
    named = np.zeros_like(clean.spoofed)
    named[60:, 3] = True
    found = aid(dataclasses.replace(clean, spoofed=named), ship.increments(), ship.config())
    assert (found.track.use[65:, 3] == Use.NAMED).all()
    assert found.track.excluded()["C04"][0][0] == 60.0


def test_the_start_is_that_of_the_ins_not_of_the_antenna():
    found = begin(ship.increments(), ship.measured(), ship.config())
    _check_start(found.start, 0.0, 8.0)
    assert found.method == "given" and found.sigma is None


def test_alignment_in_motion_with_a_swinging_antenna():
    config = ship.config(aided={"attitude_deg": None})
    found = begin(ship.increments(), ship.measured(), config)
    assert found.start.time_s == 60.0 and found.method == "in motion over 60 s"
    _check_start(found.start, 60.0, 8.0)
    truth = ship.SHIP.attitude_rad(np.array([60.0]))[0]
    off = np.abs(np.array(found.start.attitude_rad) - truth)
    assert (off < 4 * np.array(found.sigma.attitude_rad)[[2, 1, 0]]).all()
    assert np.degrees(off).max() < 2.0


def _check_start(start, time_s, within_m):
    at = np.array([time_s])
    away = np.array(start.position_m) - ship.SHIP.body(at)[0]
    assert np.linalg.norm(away) < within_m
    speed = np.array(start.velocity_m_s) - ship.SHIP.body_velocity_m_s(at)[0]
    assert np.linalg.norm(speed) < 0.3


def test_alignment_at_rest():
    still = Trajectory(OnPlane(ship.ORIGIN, lambda t: np.zeros((t.size, 3))), upright, (0.5, 0, -2))
    sky = sim.fixed(ship.TIME, still.position_m(np.zeros(1))[0], ship.LOOKS)
    measured = sim.simulate(still, sky, ship.TIME, reference=ship.REFERENCE).run()
    ideal = ideal_increments(still, 90.0, 100.0, reference=ship.REFERENCE)
    log = read(ideal, draw("navigation", 1)[0]).log
    found = begin(log, measured, ship.config(aided={"attitude_deg": None, "grade": "navigation"}))
    assert found.method.endswith("at rest")
    assert np.degrees(found.start.attitude_rad[0]) == pytest.approx(40.0, abs=0.5)
    away = np.array(found.start.position_m) - still.body(np.zeros(1))[0]
    assert np.linalg.norm(away) < 5.0


def upright(time_s):
    return np.radians(np.array([[40.0, 1.0, -2.0]])) * np.ones((time_s.size, 1))


def test_a_grade_sets_what_the_filter_believes():
    config = with_hardware(ship.config(aided={"grade": "tactical"}))
    assert config.tight.gyro_bias_deg_h == pytest.approx(1.0)
    assert config.tight.accelerometer_bias_ug == pytest.approx(1000.0)
    assert config.rate.grade == "tactical"
    # A TCXO of h-2 = 2e-20: 2 pi^2 c^2 h-2.
    assert config.tight.clock_drift_m2_s3 == pytest.approx(0.0355, abs=1e-4)
    plain = with_hardware(ship.config(aided={"oscillator": ""}))
    assert plain.tight.clock_drift_m2_s3 == TightConfig().clock_drift_m2_s3
    own = ship.config(tight={"gyro_bias_deg_h": 3.0}, aided={"grade": "tactical"})
    assert with_hardware(own).tight.gyro_bias_deg_h == 3.0
    with pytest.raises(ConfigError, match="no IMU grade 'gold'"):
        with_hardware(ship.config(aided={"grade": "gold"}))


def test_without_a_fix_it_cannot_begin():
    few = ship.measured()
    ranges = few.range_m.copy()
    ranges[:, 3:] = np.nan
    with pytest.raises(AidingError, match="to begin with; give more satellites"):
        aid(dataclasses.replace(few, range_m=ranges), ship.increments(), ship.config())


def test_a_short_recording_is_not_enough():
    few = ship.measured().part(0, 20)
    found = aid(few, ship.increments(), ship.config())
    assert found.verdict.verdict == "not enough support"
    assert any("has not settled" in note for note in found.verdict.notes)
