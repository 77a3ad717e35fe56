"""From simulated measurements and increments to a verdict."""

from __future__ import annotations

import dataclasses

import aided_ship as ship
import numpy as np
import pytest

from sdr_spoof.aided.records import Guard, Use
from sdr_spoof.aided.run import aid, with_grade
from sdr_spoof.aided.start import start_of
from sdr_spoof.aiding import simulated as sim
from sdr_spoof.errors import AidingError, ConfigError

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
    assert found.verdict.verdict == "clean" and found.story == ()
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
    config = ship.config()
    measured = dataclasses.replace(ship.measured(), range_m=ship.measured().range_m)
    start = start_of(ship.increments(), measured, config)
    away = np.array(start.position_m) - ship.SHIP.body(np.zeros(1))[0]
    assert np.linalg.norm(away) < 8.0
    speed = np.array(start.velocity_m_s) - ship.SHIP.body_velocity_m_s(np.zeros(1))[0]
    assert np.linalg.norm(speed) < 0.3


def test_a_grade_sets_what_the_filter_believes():
    config = with_grade(ship.config(aided={"grade": "tactical"}))
    assert config.tight.gyro_bias_deg_h == pytest.approx(1.0)
    assert config.tight.accelerometer_bias_ug == pytest.approx(1000.0)
    assert config.rate.grade == "tactical"
    own = ship.config(tight={"gyro_bias_deg_h": 3.0}, aided={"grade": "tactical"})
    assert with_grade(own).tight.gyro_bias_deg_h == 3.0
    with pytest.raises(ConfigError, match="no IMU grade 'gold'"):
        with_grade(ship.config(aided={"grade": "gold"}))


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
