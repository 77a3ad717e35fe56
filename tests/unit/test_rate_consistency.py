"""Rate consistency with an INS: changes, laws, power, what alarms and what must not."""

from dataclasses import replace

import numpy as np
import pytest
from aided_flights import (
    DIRECTIONS,
    MICRO_G,
    circle,
    config,
    drifting,
    measured,
    straight,
    to_earth,
    true_states,
)

from sdr_spoof import decision
from sdr_spoof.aiding import detectors as aided
from sdr_spoof.aiding.detectors import budget, growth, local_mean, power
from sdr_spoof.aiding.detectors.changes import States, changes
from sdr_spoof.aiding.detectors.prepared import prepare
from sdr_spoof.aiding.rate_config import RateConfig
from sdr_spoof.aiding.simulated import hover, position_step, velocity_drag
from sdr_spoof.errors import ConfigError, NavigationError
from sdr_spoof.nav.time import GnssTime

SILENT = {"code_white_m": 0.0, "code_markov_m": 0.0}
TIMES = np.arange(301.0)


def alarm(name, measurements, states, settings, quantity=None):
    """Decision of the threshold rule on the first series, or the one named."""
    for series in aided.find(name).statistics(measurements, states, settings):
        if quantity in (None, series.quantity):
            return decision.decide(series, settings.detection), series
    raise AssertionError(quantity)


def test_displacements_of_a_turn_are_those_over_the_interval():
    # 3 m/s^2 across: the velocity at the end would be off by 1.5 m/s.
    way = circle()
    clean = measured(way, TIMES, carrier_m=0.0, **SILENT)
    found = changes(clean, true_states(way, TIMES), RateConfig())
    np.testing.assert_allclose(found.displacement_m[1:], 0.0, atol=1e-6)
    at_end = np.diff(way.position_m(TIMES), axis=0) - way.velocity_m_s(TIMES)[1:]
    assert np.linalg.norm(at_end, axis=1).mean() == pytest.approx(1.5, abs=0.01)


def test_an_error_of_the_ins_and_a_drag_have_their_signs():
    way = straight()
    states = true_states(way, TIMES)
    drag = velocity_drag((0.0, 0.1, 0.0), 100.0, 200.0)
    found = changes(measured(way, TIMES, [drag], 0.0, **SILENT), states, RateConfig())
    np.testing.assert_allclose(found.displacement_m[110:200, 1], 0.1, atol=1e-5)
    up = way.position_m(TIMES)
    fast = replace(states, position_m=up + TIMES[:, None] * 0.2 * up / np.linalg.norm(up[0]))
    found = changes(measured(way, TIMES, (), 0.0, **SILENT), fast, RateConfig())
    np.testing.assert_allclose(found.displacement_m[1:, 2], -0.2, atol=1e-3)


def test_noise_of_changes_is_that_of_two_phases():
    way, times = straight(), np.arange(2000.0)
    found = changes(measured(way, times), true_states(way, times), RateConfig())
    moved = found.displacement_m[1:]
    expected = 2 * np.diagonal(found.covariance_m2[1:], axis1=1, axis2=2).mean(axis=0)
    # Variance of a variance of MA(1) noise: 2 (1 + 2 rho^2) / n.
    np.testing.assert_allclose(moved.var(axis=0), expected, rtol=4 * np.sqrt(3.0 / 2000))
    neighbours = (moved[1:] * moved[:-1]).mean(axis=0) / moved.var(axis=0)
    np.testing.assert_allclose(neighbours, -0.5, atol=4 / np.sqrt(2000))


def test_schuler_growth_of_a_standing_ins():
    # R eps (1 - cos w t) north of 0.1 deg/h about east; b / w sin w t east of 10 ug.
    times = np.arange(1750.0)
    place = straight().position_m(np.zeros(1))
    states = States(
        np.repeat(place, 1750, axis=0),
        np.zeros((1750, 3)),
        np.repeat(to_earth(place), 1750, axis=0),
        times,
    )
    steps = growth.steps(states, times, budget.of(RateConfig()))
    error = np.zeros((2, 1750, 15))
    error[0, :, growth.GYRO] = np.array([0.0, 0.1, 0.0]) * np.radians(1) / 3600
    error[1, :, growth.ACCELEROMETER] = np.array([0.0, 10.0, 0.0]) * MICRO_G
    for k in range(1, 1750):
        error[:, k] = error[:, k - 1] @ steps.transition[k].T
    velocity = error[..., growth.VELOCITY] @ to_earth(place)[0]
    when = [200, 650, 1500, 1749]
    np.testing.assert_allclose(-velocity[0, when, 0], [0.0945, 0.949, 3.95, 4.80], rtol=0.01)
    np.testing.assert_allclose(velocity[1, when, 1], [0.0194, 0.0570, 0.0749, 0.0639], rtol=0.01)


def test_local_mean_ignores_lines_and_has_its_variance():
    line = 3.0 + 0.2 * np.arange(200.0)
    np.testing.assert_allclose(local_mean.statistic(line, 10, 60)[69:], 0.0, atol=1e-12)
    assert np.isnan(local_mean.statistic(line, 10, 60)[:69]).all()
    phase = np.random.default_rng(1).standard_normal((4000, 71))
    values = local_mean.statistic(np.diff(phase, axis=1), 10, 60)[:, -1]
    # One sample of differenced phase has variance 2.
    expected = 2 * local_mean.variance_factor(10, 60)
    assert values.var() == pytest.approx(expected, rel=4 * np.sqrt(2 / 4000))
    assert local_mean.variance_factor(10, 60, "independent") == pytest.approx(0.185, abs=0.001)


def test_samples_that_the_published_drag_needs():
    north, east = 0.1366 / 2.5758, 0.2071 / 2.5758
    assert float(power.power(0.1, north, 0.01)) == pytest.approx(0.245, abs=0.001)
    assert float(power.power(0.1, east, 0.01)) == pytest.approx(0.091, abs=0.001)
    found = power.fewest(0.1, [north, east], 0.0, 0.01, 0.9, 100, "independent")
    assert found.tolist() == [5, 10]
    assert [power.fewest_for_t(0.1, s, 0.01, 0.9) for s in (north, east)] == [8, 14]
    # Differenced phase averages as 1/K: the root of it.
    assert power.fewest(0.1, [north, east], 0.0, 0.01, 0.9, 100).tolist() == [3, 4]
    assert power.fewest(0.1, [0.01, 0.01], [0.02, 0.05], 0.01, 0.9, 100).tolist() == [1, 0]


@pytest.mark.parametrize("grade", [1.0, 5.0])
@pytest.mark.parametrize("way", [straight(), circle()])
def test_a_drifting_ins_raises_no_alarm(grade, way):
    signs = np.array([1.0, -1.0, 1.0])
    states = drifting(way, TIMES, 0.1 * grade * signs, 10.0 * grade * signs)
    settings = config(grade="n1" if grade == 1.0 else "n2")
    clean = measured(way, TIMES)
    for name in aided.AIDED:
        for series in aided.find(name).statistics(clean, states, settings):
            assert decision.decide(series, settings.detection) is None, name


def test_the_published_drag_is_found_at_once_and_the_alarm_stays():
    way = circle()
    states = drifting(way, TIMES, (0.5, 0.5, -0.5), (50.0, -50.0, 50.0))
    settings = config(grade="n2")
    attacked = measured(way, TIMES, [velocity_drag((0.0, 0.1, 0.0), 150.0, 200.0)])
    decided, series = alarm("rate_drag", attacked, states, settings)
    assert decided.onset_s == pytest.approx(150.0, abs=1.0)
    assert 150.0 < decided.alarm_s <= 153.0
    assert series.tested_s() > 250.0
    way = straight()
    attacked = measured(way, TIMES, [velocity_drag((0.0, 0.1, 0.0), 150.0, 200.0)])
    states = drifting(way, TIMES, (0.5, 0.5, -0.5), (50.0, -50.0, 50.0))
    decided, _ = alarm("rate_local", attacked, states, settings, "north")
    assert 150.0 < decided.alarm_s <= 160.0


def test_hover_and_step_are_spikes_of_the_rate():
    way = straight()
    states = drifting(way, TIMES, (0.1, 0.1, 0.1))
    settings = config(grade="n1", samples="one")
    attacks = [hover(25.0, 50.0), position_step((100.0, 0.0, 0.0), 60.0, 80.0)]
    attacked = measured(way, TIMES, attacks)
    decided, series = alarm("rate_consistency", attacked, states, settings, "north")
    assert decided.alarm_s == 26.0
    assert series.value[series.time_s == 40.0] == pytest.approx(-40.0, abs=0.1)
    _, series = alarm("rate_consistency", attacked, states, settings, "east")
    rate = dict(zip(series.time_s, series.value, strict=True))
    assert rate[60.0] == pytest.approx(100.0, abs=0.1)
    assert rate[70.0] == pytest.approx(0.0, abs=0.1)
    assert rate[80.0] == pytest.approx(-100.0, abs=0.1)


def test_an_old_ins_is_not_enough_support():
    way = straight()
    states = drifting(way, TIMES, (0.1, 0.1, 0.1))
    old = replace(states, aligned_s=states.aligned_s + 1500.0)
    settings = config(grade="n1")
    _, series = alarm("rate_consistency", measured(way, TIMES), old, settings, "north")
    assert series.time_s.size == 0
    assert "align it anew" in " ".join(series.notes)
    _, series = alarm("rate_drag", measured(way, TIMES), old, settings)
    assert series.time_s.size > 200


def test_single_satellites_are_named():
    way = straight()
    settings = config(grade="n1", samples="one", align_heading_deg=0.001)
    pull = velocity_drag((0.0, 3.0, 0.0), 50.0, satellites=("C03",))
    attacked = measured(way, TIMES, [pull])
    found = {}
    for series in aided.find("rate_satellites").statistics(
        attacked, true_states(way, TIMES), settings
    ):
        decided = decision.decide(series, settings.detection)
        if decided:
            found[series.system, series.prn] = abs(decided.statistic / decided.threshold)
    assert max(found, key=found.get) == ("C", 3)


def test_a_step_of_position_is_seen_by_the_position_form():
    way = straight()
    settings = config(grade="n1", align_heading_deg=0.001)
    attacked = measured(way, TIMES, [position_step((100.0, 0.0, 0.0), 60.0)])
    decided, _ = alarm("position_consistency", attacked, true_states(way, TIMES), settings, "east")
    assert decided.alarm_s == 60.0


def test_gaps_realignment_and_new_satellites_raise_no_alarm():
    way = circle()
    states = drifting(way, TIMES, (0.5, -0.5, 0.5), (50.0, 50.0, -50.0))
    clean = measured(way, TIMES)
    change = clean.change_m.copy()
    change[100:110] = np.nan
    change[150:200, 0] = np.nan
    change[180:, 1] = np.nan
    broken = replace(clean, change_m=change)
    settings = config(grade="n2")
    decided, series = alarm("rate_drag", broken, states, settings)
    assert decided is None
    assert len(np.unique(series.segment)) == 2
    true = true_states(way, TIMES)
    again = replace(
        states,
        position_m=np.where(TIMES[:, None] < 200, states.position_m, true.position_m),
        velocity_m_s=np.where(TIMES[:, None] < 200, states.velocity_m_s, true.velocity_m_s),
        aligned_s=np.where(TIMES < 200, TIMES, TIMES - 200),
    )
    for name in ("rate_drag", "rate_local", "rate_consistency"):
        assert alarm(name, clean, again, settings)[0] is None


def test_an_ins_that_begins_late_and_ends_early_is_tested_where_it_is():
    way = circle()
    late = drifting(way, TIMES[50:], (0.5, -0.5, 0.5), (50.0, 50.0, -50.0))
    ends = {
        name: getattr(late, name)[:-30]
        for name in ("time_s", "position_m", "velocity_m_s", "attitude_rad", "aligned_s")
    }
    late, settings = replace(late, **ends), config(grade="n2")
    drag = velocity_drag((0.0, 0.1, 0.0), 150.0)
    for name in aided.AIDED:
        for series in aided.find(name).statistics(measured(way, TIMES), late, settings):
            assert decision.decide(series, settings.detection) is None, name
            assert not ((series.time_s < 50.0) | (series.time_s > 270.0)).any(), name
    decided, _ = alarm("rate_drag", measured(way, TIMES, [drag]), late, settings)
    assert 150.0 < decided.alarm_s <= 153.0


def test_few_and_degenerate_satellites_are_no_support():
    way = straight()
    states = true_states(way, TIMES)
    clean = measured(way, TIMES)
    few = clean.change_m.copy()
    few[:, 4:] = np.nan
    settings = config(grade="n1")
    decided, series = alarm("rate_drag", replace(clean, change_m=few), states, settings)
    assert decided is None
    assert series.time_s.size == 0
    assert "fewer than 5 satellites" in " ".join(series.notes)
    together = clean.satellite_m.copy()
    together[:, 1:] = together[:, :1] + np.arange(1, len(DIRECTIONS))[None, :, None] * 1e3
    _, series = alarm("rate_drag", replace(clean, satellite_m=together), states, settings)
    assert series.time_s.size == 0
    assert "degenerate" in " ".join(series.notes)


def test_times_that_do_not_fit_are_refused():
    way = straight()
    clean = measured(way, TIMES)
    later = replace(true_states(way, TIMES), time_s=TIMES + 1000.0)
    with pytest.raises(NavigationError, match="do not overlap"):
        prepare(clean, later, RateConfig())
    dated = replace(true_states(way, TIMES), reference=GnssTime(1_000_000_000))
    with pytest.raises(NavigationError, match="reference time"):
        prepare(clean, dated, RateConfig())
    dated_too = replace(clean, reference=GnssTime(1_000_000_100))
    found = changes(dated_too, replace(dated, time_s=TIMES + 100.0), RateConfig())
    assert np.isfinite(found.displacement_m[1:]).all()


def test_unknown_names_are_refused():
    with pytest.raises(ConfigError, match="known detectors: rate_drag"):
        aided.find("nothing")
    with pytest.raises(ConfigError, match="no IMU grade"):
        budget.of(RateConfig(grade="perfect"))
