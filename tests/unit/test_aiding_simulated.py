"""Simulated measurements against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from skies import PLACE as GROUND
from skies import VACUUM

from sdr_spoof.aiding import simulated as sim
from sdr_spoof.aiding.simulated.clock import IDEAL
from sdr_spoof.aiding.simulated.noise import SILENT
from sdr_spoof.nav.geodesy import azimuth_elevation, enu_matrix, geodetic_to_ecef
from sdr_spoof.scenario.sky import SkyTable
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory

ORIGIN = np.array([34.0, 108.0, 400.0])
PLACE = geodetic_to_ecef(ORIGIN)
AXES = enu_matrix(34.0, 108.0)
LOOKS = [(20, 72), (70, 36), (150, 42), (230, 34), (310, 47)]
TIME = np.arange(61.0)


def curve(time_s):
    """A turn with 10 m/s and 1 rad in 20 s."""
    angle = time_s / 20
    return np.stack([200 * np.sin(angle), 200 * np.cos(angle), 0 * angle], axis=-1)


CIRCLE = Trajectory(OnPlane(ORIGIN, curve))
STILL = (np.broadcast_to(PLACE, (TIME.size, 3)), np.zeros((TIME.size, 3)))
STANDING = sim.fixed(TIME, PLACE, LOOKS)


def silent(antenna=CIRCLE, sky=STANDING, **other):
    return sim.simulate(antenna, sky, TIME, SILENT, IDEAL, **other)


def test_ranges_rates_and_changes_are_of_one_geometry():
    found = silent().run()
    fine = np.arange(0, 60.0001, 1e-3)
    places = CIRCLE.position_m(fine)
    way = np.linalg.norm(STANDING.position_m[0, 0] - places, axis=1)
    np.testing.assert_allclose(found.range_m[:, 0], way[::1000], atol=1e-7)
    derivative = np.gradient(way, 1e-3)[1000:-1:1000]
    np.testing.assert_allclose(found.rate_m_s[1:-1, 0], derivative[: TIME.size - 2], atol=2e-5)
    np.testing.assert_allclose(found.change_m[1:], np.diff(found.range_m, axis=0), atol=1e-12)
    assert np.isnan(found.change_m[0]).all()


def test_given_directions_are_where_the_satellites_are():
    seen = azimuth_elevation(PLACE, STANDING.position_m[5])
    np.testing.assert_allclose(seen, LOOKS, atol=1e-9)


def test_orbits_of_a_sky():
    table = SkyTable.model_validate(
        {"start": "2023-03-12T12:00:00", "receiver": GROUND, "cn0_horizon_dbhz": 35.0} | VACUUM
    )
    time_s = np.arange(0.0, 4.0, 0.1)
    ground = geodetic_to_ecef([31.2, 121.5, 30.0])
    speed = np.array([100.0, -200.0, 50.0])
    places = ground + time_s[:, None] * speed
    sky = sim.of_sky(table, time_s, places, speed)
    found = sim.simulate((places, np.broadcast_to(speed, places.shape)), sky, time_s, SILENT, IDEAL)
    run = found.run()
    assert set(run.systems) == {"C", "G"}
    middle = (run.range_m[2:] - run.range_m[:-2]) / 0.2
    np.testing.assert_allclose(run.rate_m_s[1:-1], middle, atol=1e-5)
    elevation = azimuth_elevation(places[0], sky.position_m[0])[:, 1]
    assert elevation.min() > 5
    np.testing.assert_allclose(sky.cn0_dbhz[0], 35 + 10 * np.sin(np.radians(elevation)), atol=1e-9)


def test_clock_has_its_covariance():
    """Two intervals ahead of a known start: (p + q T^2 ...) as the sum of both steps."""
    clock = sim.ClockWalk(100.0, 0.3, 0.01, 0.0004)
    found = sim.simulate(STILL, STANDING, TIME, SILENT, clock, runs=400, seed=3)
    k = 60
    offset = found.clock_m[:, k] - 100.0 - 0.3 * k
    drift = found.drift_m_s[:, k] - 0.3
    law = {
        "offset": (offset**2, 0.01 * k + 0.0004 * k**3 / 3),
        "drift": (drift**2, 0.0004 * k),
        "both": (offset * drift, 0.0004 * k**2 / 2),
    }
    for values, expected in law.values():
        error = values.std() / math.sqrt(values.size)
        assert abs(values.mean() - expected) < 4 * error


def test_noise_has_its_law():
    noise = sim.ReceiverNoise(1.0, 1.5, 20.0, 0.002, 0.05)
    found = sim.simulate(STILL, STANDING, TIME, noise, IDEAL, runs=300, seed=5)
    truth = silent(STILL)
    code = found.range_m - truth.range_m
    change = found.change_m[:, 1:]
    rate = found.rate_m_s

    def near(values, expected):
        per_run = values.mean(axis=(1, 2))
        assert abs(per_run.mean() - expected) < 4 * per_run.std() / math.sqrt(per_run.size)

    near(code**2, 1.0 + 1.5**2)
    near(code[:, 5:] * code[:, :-5], 1.5**2 * math.exp(-5 / 20))
    near(change**2, 2 * 0.002**2)
    near(change[:, 1:] * change[:, :-1], -(0.002**2))
    near(rate**2, 0.05**2)


def test_a_run_does_not_depend_on_the_others():
    few = sim.simulate(CIRCLE, STANDING, TIME, runs=2, seed=9)
    many = sim.simulate(CIRCLE, STANDING, TIME, runs=4, seed=9)
    np.testing.assert_array_equal(few.range_m, many.range_m[:2])
    attack = sim.clock_step(10.0, 30.0)
    hit = sim.simulate(CIRCLE, STANDING, TIME, attacks=[attack], runs=2, seed=9)
    np.testing.assert_array_equal(hit.range_m[:, :30], few.range_m[:, :30])
    np.testing.assert_allclose(hit.range_m[:, 30:] - few.range_m[:, 30:], 10.0, atol=1e-7)


def position_of(found, row):
    """The antenna that noiseless ranges tell of, east, north, up against the true one."""
    sky = found.constellation.position_m[row]
    where = found.position_m[row].copy()
    for _ in range(5):
        way = where - sky
        distance = np.linalg.norm(way, axis=1)
        design = np.column_stack([way / distance[:, None], np.ones(len(sky))])
        step = np.linalg.lstsq(design, found.range_m[0, row] - distance, rcond=None)[0]
        where = where + step[:3]
    return enu_matrix(*ORIGIN[:2]) @ (where - found.position_m[row])


@pytest.mark.parametrize(
    ("attack", "expected"),
    [
        (sim.position_step((100.0, 0.0, 0.0), 20), [100.0, 0.0, 0.0]),
        (sim.velocity_drag((0.0, 0.5, 0.0), 20), [0.0, 15.0, 0.0]),
        (sim.accelerated_drag((0.0, 0.0, 0.02), 20), [0.0, 0.0, 9.0]),
        (sim.clock_drag(1.0, 20), [0.0, 0.0, 0.0]),
        (sim.hover(20), curve(np.array([20.0]))[0] - curve(np.array([50.0]))[0]),
    ],
)
def test_what_the_false_ranges_tell(attack, expected):
    found = silent(attacks=[attack])
    np.testing.assert_allclose(position_of(found, 50), expected, atol=0.02)
    np.testing.assert_allclose(position_of(found, 19), 0.0, atol=1e-6)
    assert found.attacked[20:].all() and not found.attacked[:20].any()
    # Rates remain the derivative of the ranges: trapezium over a smooth second.
    mean = (found.rate_m_s[0, 31:] + found.rate_m_s[0, 30:-1]) / 2
    np.testing.assert_allclose(found.change_m[0, 31:], mean, atol=2e-3)


def test_hover_stands_still():
    found = silent(attacks=[sim.hover(20.5, 40)])
    run = found.run()
    np.testing.assert_allclose(run.change_m[22:40], 0.0, atol=1e-6)
    np.testing.assert_allclose(run.rate_m_s[21:40], 0.0, atol=1e-6)


def test_false_trajectory():
    other = Trajectory(OnPlane(ORIGIN, lambda t: curve(t) + np.array([50.0, 0.0, 0.0])))
    found = silent(attacks=[sim.false_trajectory(other, 10, 30)])
    truth = silent(other)
    np.testing.assert_allclose(found.range_m[0, 10:30], truth.range_m[0, 10:30], atol=1e-7)
    np.testing.assert_allclose(found.rate_m_s[0, 10:30], truth.rate_m_s[0, 10:30], atol=1e-5)


def test_a_subset_and_codes_alone():
    taken = ("C02", "C04")
    attack = sim.velocity_drag((1.0, 0.0, 0.0), 10, 40, satellites=taken, code_only=True)
    found, truth = silent(attacks=[attack]), silent()
    moved = np.abs(found.range_m - truth.range_m)[0].max(axis=0) > 1e-9
    assert moved.tolist() == [False, True, False, True, False]
    np.testing.assert_array_equal(found.rate_m_s, truth.rate_m_s)
    np.testing.assert_array_equal(found.change_m[:, 1:], truth.change_m[:, 1:])


def test_a_jump_with_power_slips():
    attack = sim.position_step((100.0, 0.0, 0.0), 10, 40, rise_db=10.0, slips=True)
    run = silent(attacks=[attack]).run()
    assert run.cn0_dbhz[[9, 10, 39, 40], 0].tolist() == [45, 55, 55, 45]
    assert np.flatnonzero(np.isnan(run.change_m[:, 0])).tolist() == [0, 10, 40]


def test_a_step_is_a_spike_in_the_change_at_both_ends():
    """As in the study: nothing between."""
    run, truth = silent(attacks=[sim.position_step((100.0, 0, 0), 10, 40)]).run(), silent().run()
    east = (run.change_m - truth.change_m)[1:]
    toward = -np.sin(np.radians([70])) * np.cos(np.radians([36])) * 100
    assert east[9, 1] == pytest.approx(toward[0], abs=0.05)
    assert east[39, 1] == pytest.approx(-toward[0], abs=0.05)
    assert np.abs(np.delete(east, [9, 39], axis=0)).max() < 0.01


def test_mistakes_are_named():
    with pytest.raises(ValueError, match="there is no satellite C99; name one of those"):
        silent(attacks=[sim.clock_step(1.0, 0, satellites=("C99",))])
    with pytest.raises(ValueError, match="evenly spaced"):
        sim.simulate(CIRCLE, STANDING, TIME**2)
    with pytest.raises(ValueError, match=r"as \(61, 3\); one is of shape \(3,\)"):
        sim.simulate((PLACE, PLACE), STANDING, TIME)
