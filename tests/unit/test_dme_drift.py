"""Sequential tests against a free INS that drifts: its errors are learnt, attacks are not."""

import dataclasses
from functools import cache

import numpy as np
import pytest

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.dme.config import SequentialConfig
from sdr_spoof.aiding.dme.drift import Drift
from sdr_spoof.aiding.dme.isolation import isolate
from sdr_spoof.aiding.dme.judge import judge
from sdr_spoof.aiding.dme.observed import differences
from sdr_spoof.aiding.dme.records import DmeLog
from sdr_spoof.aiding.dme.stations import Station, sigma_m, slant_ranges_m
from sdr_spoof.aiding.imu import grades
from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.aiding.simulated import (
    ClockWalk,
    ReceiverNoise,
    fixed,
    range_pull,
    simulate,
    velocity_drag,
)
from sdr_spoof.errors import ConfigError
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.report import sequential_words as words
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory

SKY = ((20, 72), (70, 36), (150, 42), (230, 34), (310, 47), (100, 60), (275, 25))
START = GnssTime.of_week(2300, 1000.0)
NOISE = ReceiverNoise(3.0, 0.0, 200.0, 0.002, 0.05)
TIME = np.arange(240.0)
RUNS = 12
FREE = SequentialConfig(ins_grade="tactical", sigma_m=3.0)


def way(time_s):
    return np.stack([200 * time_s, 2000 * (1 - np.cos(time_s / 60)), 0 * time_s], axis=1)


AIRCRAFT = Trajectory(OnPlane(np.array([34.0, 108.0, 10_000.0]), way))


@cache
def truth():
    return true_states(AIRCRAFT, TIME)


@cache
def drifting():
    """What INS of a grade say, aligned at the first epoch as [rate] has it."""
    log = ideal_increments(AIRCRAFT, TIME[-1], 50.0)
    left = np.array([3, 3, 3, 0.005, 0.005, 0.005, *np.radians([0.002, 0.002, 0.05])])
    states = strapdown.navigate_runs(
        log,
        true_states(AIRCRAFT, np.zeros(1)),
        grades.draw("tactical", 3, RUNS),
        every=50,
        alignment_errors=left * np.random.default_rng(5).standard_normal((RUNS, 1, 9)),
    )
    names = ("position_m", "velocity_m_s", "attitude_rad")
    rows = [[getattr(states, n)[k] for n in names] for k in range(RUNS)]
    return [InertialStates(START, TIME, *row, TIME) for row in rows]


def measured(attacks=(), seed=1):
    antenna = (truth().position_m, truth().velocity_m_s)
    sky = fixed(TIME, truth().position_m[0], SKY)
    clock = ClockWalk(1000.0, 5.0)
    return simulate(antenna, sky, TIME, NOISE, clock, attacks, seed, reference=START).run()


def test_a_drift_is_no_attack_once_the_grade_is_told():
    for k, ins in enumerate(drifting()[:3]):
        seen = measured(seed=k)
        untold = judge(seen, ins)
        assert untold.alarm_s is not None or untold.notes
        told = judge(seen, ins, None, FREE)
        assert told.alarm_s is None
        assert told.notes == ()
        spread = np.array([t.series.value.std() for t in told.tested])
        assert np.all(np.abs(spread - 1.0) < 4 / np.sqrt(2 * TIME.size))
    assert np.linalg.norm(ins.position_m[-1] - truth().position_m[-1]) > 50.0
    assert "a free one of grade “tactical”" in words.drift(told, FREE)


def test_the_error_is_expected_as_well_as_stated():
    squares = []
    for k, ins in enumerate(drifting()):
        seen = measured(seed=k)
        found = differences(seen, ins, None, FREE)
        expected = Drift.of(seen, ins, FREE).expected(found)
        true = (ins.position_m - truth().position_m) @ found.axes.T
        off = (true - expected.error_m)[[60, 150, 239]]
        root = np.linalg.cholesky(expected.error_m2[[60, 150, 239]])
        white = np.linalg.solve(root, off[..., None])
        squares.append((white[..., 0] ** 2).sum(axis=-1))
    # Three of freedom each; the prediction at one time knows little of that at another.
    mean = np.mean(squares, axis=0)
    assert np.all(mean < 3.0 + 4 * np.sqrt(6.0 / RUNS))
    assert np.all(mean > 0.5)


def test_a_pulled_satellite_is_named_against_a_drifting_ins():
    attack = range_pull((15.0, 0.0, 0.0), 150.0, satellites=("C03",))
    found = judge(measured([attack]), drifting()[0], None, FREE)
    assert 150.0 <= found.alarm_s < 170.0
    assert found.spoofed == ("C03",)


def test_alone_it_grows_uncertain():
    seen, ins = measured(), drifting()[0]
    found = differences(seen, ins, None, FREE)
    alone = Drift.of(seen, ins, FREE).expected(found, until_s=100.0)
    size = np.sqrt(np.trace(alone.error_m2, axis1=1, axis2=2))
    assert np.all(np.diff(size[101:]) > 0.0)
    true = (ins.position_m - truth().position_m) @ found.axes.T
    assert np.linalg.norm(alone.error_m[160] - true[160]) < 4 * size[160]


def test_places_alone_will_do():
    nothing = np.full((TIME.size, 3), np.nan)
    ins = dataclasses.replace(drifting()[1], velocity_m_s=nothing, attitude_rad=nothing)
    assert judge(measured(), ins, None, FREE).alarm_s is None


def test_an_older_ins_may_be_further_off():
    seen, ins = measured(), drifting()[0]
    found = differences(seen, ins, None, FREE)
    sizes = [
        Drift.of(seen, ins, SequentialConfig(ins_grade="tactical", ins_aligned_s=age_s))
        .expected(found)
        .error_m2[0, 0, 0]
        ** 0.5
        for age_s in (0.0, 300.0)
    ]
    assert sizes[0] == pytest.approx(3.0, rel=0.01)
    assert sizes[1] > 100.0
    assert Drift.of(seen, ins, SequentialConfig()) is None
    with pytest.raises(ConfigError, match="no IMU grade"):
        Drift.of(seen, ins, SequentialConfig(ins_grade="best"))


def test_isolation_allows_for_what_the_ins_may_be_off():
    seen = differences(measured(), drifting()[0], None, FREE)
    geometry = seen.geometry(0)
    error, sigma = np.array([30.0, -20.0, 5.0]), np.diag([40.0, 40.0, 10.0]) ** 2
    shifted = geometry.design[:, :3] @ error
    assert isolate(shifted, geometry, 30).satellites != ()
    assert isolate(shifted, geometry, 30, expected=(0 * error, sigma)).satellites == ()
    assert isolate(shifted, geometry, 30, expected=(error, 0 * sigma)).satellites == ()
    shifted[2] += 40.0
    assert isolate(shifted, geometry, 30, expected=(0 * error, sigma)).satellites == (2,)


STATIONS = (Station("NORTH", 34.6, 108.4, 400.0), Station("SOUTH", 33.6, 108.8, 500.0))


def ranges():
    true = slant_ranges_m(STATIONS, truth().position_m)
    noise = sigma_m(true) * np.random.default_rng(2).standard_normal(true.shape)
    which = np.tile([0, 1], TIME.size)
    return DmeLog(START, STATIONS, np.repeat(TIME, 2), which, (true + noise).ravel() + 30.0)


def test_what_is_learnt_of_a_false_trajectory_contradicts_dme():
    drag = velocity_drag((0.0, 4.0, 0.0), 60.0)
    found = judge(measured([drag]), drifting()[2], ranges(), FREE)
    assert found.captured
    said = " ".join(words.sentences(found))
    assert "DME contradicts the place that INS and satellites give" in said
    assert judge(measured(), drifting()[2], ranges(), FREE).alarm_s is None
