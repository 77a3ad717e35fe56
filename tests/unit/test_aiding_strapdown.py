"""Strapdown navigation by its Python interface; the arithmetic is tested in the core."""

from dataclasses import replace

import numpy as np
import pytest
from inertial_paths import local, rest, resting

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.imu import grades
from sdr_spoof.aiding.imu.errors import ImuErrors, SensorErrors
from sdr_spoof.errors import InertialError

MICRO_G = 9.80665e-6
DEG_HOUR = np.radians(1.0) / 3600


def test_at_rest_it_stays_at_rest_in_both_axes():
    log, start = rest(300.0)
    for mechanisation in ("local", "earth-fixed"):
        states = strapdown.navigate(log, start, every=100, mechanisation=mechanisation)
        assert states.time_s.tolist() == list(range(301))
        assert np.abs(states.position_m - start.position_m).max() < 1e-5
        assert np.abs(states.velocity_m_s).max() < 1e-7
        assert np.allclose(states.attitude_rad, start.attitude_rad, atol=1e-9)
        assert np.array_equal(states.aligned_s, states.time_s)


def test_schuler_numbers_of_the_published_biases():
    log, start = rest(1750.0, attitude_rad=(0.0, 0.0, 0.0))
    at = [200, 650, 1500, 1749]
    gyro = ImuErrors(gyro=SensorErrors(bias=(0.0, 0.1 * DEG_HOUR, 0.0)))
    force = ImuErrors(accelerometer=SensorErrors(bias=(0.0, 10 * MICRO_G, 0.0)))
    states = strapdown.navigate_runs(log, start, [gyro, force], every=100)
    east, north, _ = np.moveaxis(local(states.velocity_m_s[:, at]), -1, 0)
    assert np.abs(north[0]) == pytest.approx([0.0945, 0.949, 3.95, 4.80], rel=0.01)
    assert east[1] == pytest.approx([0.0194, 0.0570, 0.0749, 0.0639], rel=0.01)


def test_errors_of_n2_are_five_times_those_of_n1():
    log, start = rest(400.0)
    one = grades.draw("n1", 3, 20)
    five = grades.draw("n2", 3, 20)
    n1, n2 = (strapdown.navigate_runs(log, start, e, every=100) for e in (one, five))
    ratio = np.linalg.norm(n2.velocity_m_s[:, -1], axis=1) / np.linalg.norm(
        n1.velocity_m_s[:, -1], axis=1
    )
    assert ratio == pytest.approx(np.full(20, 5.0), rel=1e-3)


def test_a_run_depends_on_its_errors_alone():
    log, start = rest(20.0)
    errors = grades.draw("ship-b", 1, 6)
    every_run = strapdown.navigate_runs(log, start, errors, every=50)
    alone = strapdown.navigate_runs(log, start, errors[4:5], every=50)
    assert np.array_equal(every_run.run(4).position_m, alone.run(0).position_m)
    assert not np.array_equal(every_run.position_m[3], every_run.position_m[4])


def test_new_alignments_take_the_truth_and_what_they_miss():
    log, start = rest(30.0)
    errors = grades.draw("n2", 1, 2)
    realign = replace(strapdown.row(start, 0), time_s=np.array([20.0]))
    missed = np.zeros((2, 2, 9))
    missed[1, 1, :3] = [3.0, 4.0, 0.0]
    states = strapdown.navigate_runs(
        log, start, errors, every=100, realign=realign, alignment_errors=missed
    )
    off = np.linalg.norm(states.position_m - start.position_m, axis=-1)
    assert (off[:, 19] > 1e-4).all()
    assert off[0, 20] == 0.0
    assert off[1, 20] == pytest.approx(5.0, abs=1e-3)
    assert states.aligned_s[[19, 20, 30]].tolist() == [19.0, 0.0, 10.0]


def test_an_altimeter_holds_the_vertical_channel():
    log, start = rest(120.0)
    errors = [ImuErrors(accelerometer=SensorErrors(bias=(0.0, 0.0, 0.01)))]
    heights = (np.array([0.0, 120.0]), np.array([400.0, 400.0]))
    free = strapdown.navigate_runs(log, start, errors, every=100)
    held = strapdown.navigate_runs(log, start, errors, every=100, altimeter=heights)
    up = [local(s.position_m[0, -1] - start.position_m[0])[2] for s in (free, held)]
    assert abs(up[0]) > 60.0
    assert abs(up[1]) < 1e-6
    with pytest.raises(InertialError, match=r"altimeter knows heights from 0.00 to 100.00 s"):
        strapdown.navigate(log, start, altimeter=(np.array([0.0, 100.0]), np.zeros(2)))


def test_a_start_within_an_interval_cuts_the_increment():
    log, _ = rest(10.0)
    start = resting(time_s=5.004)
    states = strapdown.navigate(log, start)
    assert states.time_s[:2] == pytest.approx([5.004, 5.01])
    assert np.abs(states.velocity_m_s).max() < 1e-6


def test_gaps_are_bridged_if_short_and_need_an_alignment_if_long():
    log, start = rest(10.0)

    def without(first: int, last: int):
        keep = np.r_[0:first, last : len(log.time_s)]
        return replace(
            log,
            time_s=log.time_s[keep],
            rotation_rad=log.rotation_rad[keep],
            velocity_m_s=log.velocity_m_s[keep],
        )

    states = strapdown.navigate(without(500, 508), start)
    assert np.abs(states.velocity_m_s[-1]).max() < 1e-6
    with pytest.raises(InertialError, match=r"misses 2.000 s at 5.000 s.*align anew at 7.000 s"):
        strapdown.navigate(without(500, 700), start)
    again = replace(start, time_s=np.array([7.0]))
    states = strapdown.navigate(without(500, 700), start, realign=again)
    assert np.abs(states.velocity_m_s[-1]).max() < 1e-6
    assert states.aligned_s[-1] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: replace(s, position_m=np.array([[34.0, 108.0, 400.0]])), "Earth-fixed"),
        (lambda s: replace(s, velocity_m_s=np.full((1, 3), np.nan)), "not a number"),
        (lambda s: replace(s, time_s=np.array([50.0])), "do the clocks of both agree"),
        (lambda s: replace(s, time_s=np.array([-3.0])), "begins 3.000 s after the start"),
        (lambda s: replace(s, position_m=np.array([[1.0, 0.0, 6.357e6]])), "earth-fixed ones"),
    ],
)
def test_starts_that_are_refused(change, message):
    log, start = rest(10.0)
    with pytest.raises(InertialError, match=message):
        strapdown.navigate(log, change(start))


def test_earth_fixed_axes_work_at_the_pole():
    log, start = rest(60.0, place=(89.9999, 20.0, 0.0))
    states = strapdown.navigate(log, start, every=100, mechanisation="earth-fixed")
    assert np.abs(states.position_m - start.position_m).max() < 1e-4


def test_runs_that_are_refused():
    log, start = rest(10.0)
    errors = grades.draw("n1", 1, 2)
    with pytest.raises(InertialError, match=r"give \(2, 1, 9\)"):
        strapdown.navigate_runs(log, start, errors, alignment_errors=np.zeros((2, 2, 9)))
    with pytest.raises(InertialError, match="no runs"):
        strapdown.navigate_runs(log, start, [])
    late = replace(start, time_s=np.array([11.0]))
    with pytest.raises(InertialError, match="outside the increments"):
        strapdown.navigate_runs(log, start, errors, realign=late)


def test_an_ins_that_runs_away_is_told():
    log, start = rest(10.0)
    wild = replace(log, velocity_m_s=1e300 * log.velocity_m_s)
    with pytest.raises(InertialError, match="run away"):
        strapdown.navigate(wild, start)
