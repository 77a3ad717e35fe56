"""What every registered decision rule keeps to."""

import numpy as np
import pytest

from sdr_spoof import decision
from sdr_spoof.decision import calibration
from sdr_spoof.decision.rule import first_alarm, latched

RULES = list(decision.RULES.values())
NEVER_ALARMS = {"improved-sprt-as-printed"}
"""Published so, and kept for comparison: no shift raises it."""


def ids(rule):
    return rule.name


@pytest.mark.parametrize("rule", RULES, ids=ids)
def test_the_path_is_a_pure_function_over_the_last_axis(rule):
    z = np.random.default_rng(1).standard_normal((2, 3, 200))
    before = z.copy()
    path = rule.run(z)
    assert path.shape == z.shape
    assert path.dtype == np.float64
    assert np.array_equal(z, before)
    for run in range(2):
        for satellite in range(3):
            np.testing.assert_array_equal(path[run, satellite], rule.run(z[run, satellite]))


@pytest.mark.parametrize("rule", RULES, ids=ids)
def test_the_path_does_not_look_ahead(rule):
    z = np.random.default_rng(2).standard_normal(300)
    np.testing.assert_allclose(rule.run(z)[:120], rule.run(z[:120]), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("rule", RULES, ids=ids)
def test_both_signs_count_alike(rule):
    z = np.random.default_rng(3).standard_normal(300)
    np.testing.assert_allclose(rule.run(-z), rule.run(z), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("rule", RULES, ids=ids)
def test_missing_samples_are_skipped(rule):
    z = np.random.default_rng(4).standard_normal(200)
    gaps = np.insert(z, [5, 50, 50, 199], [np.nan, np.nan, np.inf, -np.inf])
    there = np.isfinite(gaps)
    path = rule.run(gaps)
    assert np.isnan(path[~there]).all()
    np.testing.assert_array_equal(path[there], rule.run(z))
    assert np.isnan(rule.run(np.full(30, np.nan))).all()
    assert rule.run(np.zeros((2, 0))).shape == (2, 0)


@pytest.mark.parametrize("rule", RULES, ids=ids)
def test_a_strong_shift_raises_it_and_the_alarm_latches(rule):
    if rule.name in NEVER_ALARMS:
        pytest.skip("never alarms")
    z = np.random.default_rng(5).standard_normal((50, 400))
    z[:, 200:300] += 8.0
    threshold = calibration.threshold_for(rule, 1e-3)
    path = rule.run(z)
    first = first_alarm(path, threshold)
    assert np.all((first >= 200) & (first < 230))
    stands = latched(path, threshold)
    assert stands[:, -1].all()
    assert np.array_equal(stands.argmax(1), first)


@pytest.mark.parametrize("rule", RULES, ids=ids)
def test_calibrated_thresholds_hold_in_plain_simulation(rule):
    if rule.name in NEVER_ALARMS:
        pytest.skip("never alarms")
    wanted, runs = 0.01, 1200
    threshold = calibration.threshold_for(rule, wanted)
    z = np.random.default_rng(6).standard_normal((runs, 3600))
    share = np.mean(rule.run(z).max(1) > threshold)
    # Four standard errors of the runs, and 15 % for those of the calibration.
    assert share == pytest.approx(wanted, abs=4 * (wanted / runs) ** 0.5 + 0.0015)


@pytest.mark.parametrize("rule", RULES, ids=ids)
def test_the_registry_names_it_as_it_names_itself(rule):
    assert decision.find(rule.name) is rule
    assert rule.title and rule.tests
    assert rule.name.replace("-", "_") in rule.path.__module__
