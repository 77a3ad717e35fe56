"""The comparison of all rules on rates against an INS."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from sdr_spoof.reproduce.ins_rate import published, rule_runs, rules_section, simulated
from sdr_spoof.reproduce.ins_rate.drag_runs import Case, flown

CASE = Case("n1", (published.DRAG_M_S,), imus=2, onsets=2, flight=0, first_s=rule_runs.FIRST_S)
RULES = {(rule.name, rule.on): rule for rule in rule_runs.rules()}


@pytest.fixture(scope="module")
def flight():
    return flown(CASE, 1)


def test_rates_of_noise_alone_have_unit_variance_with_and_without_the_line(flight):
    z = rule_runs.rates(flight, flight.noise_m)
    for values in (z, rule_runs.differenced(z)):
        known = values[np.isfinite(values)]
        # Squares of differences go together over two epochs, those of one run's axes too.
        error = (2 * 3 * 1.5 / known.size) ** 0.5
        assert known.var() == pytest.approx(1.0, abs=4 * error)
    assert simulated.dilution().shape == (3, 3)


@pytest.mark.parametrize("name", ["trained-threshold", "t-test", "cusum", "glr-windows"])
def test_drift_breaks_what_has_the_law_of_noise(flight, name):
    rule = RULES[name, rule_runs.EPOCH]
    judged = rule_runs._judged(rule, flight)
    found = rules_section.compared("n1", rule, [judged, judged])
    assert found.by_law[0] > 0.95
    assert found.broken
    assert found.within(10.0) < 0.5


@pytest.mark.parametrize(
    ("name", "on"), [("local mean", "rate_local"), ("likelihood ratio", "rate_drag")]
)
def test_the_covariance_of_the_ins_keeps_the_law(flight, name, on):
    rule = RULES[name, on]
    found = rules_section.compared("n1", rule, [rule_runs._judged(rule, flight)] * 2)
    assert not found.broken
    assert found.delay_s.shape == (4, 2)
    assert found.within(10.0) == 1.0
    assert found.median_s() <= 3.0


def test_an_alarm_that_stood_before_is_not_counted():
    after = np.array([[[0.0, 0.0, 5.0], [5.0, 5.0, 5.0], [0.0, np.nan, 1.0]]])
    np.testing.assert_array_equal(rule_runs.delay_s(after, 2.0), [[2.0, np.inf, np.inf]])
    limits = np.array([2.0, 0.5])
    both = rule_runs.delay_s(np.concatenate([after, after]), limits)
    np.testing.assert_array_equal(both[1], [2.0, np.inf, 2.0])


def test_each_half_is_judged_by_the_other():
    rng = np.random.default_rng(2)
    rule = replace(RULES["likelihood ratio", "rate_drag"], stated=float(chi2.isf(0.05, 3)))
    judged = rule_runs.Judged(np.empty((0, 0)), rng.chisquare(3, (20, 2000)), np.zeros((20, 1, 3)))
    found = rules_section.compared("n1", rule, [judged])
    error = (0.05 * 0.95 / 40000) ** 0.5
    assert found.by_law[0] == pytest.approx(0.05, abs=4 * error)
    assert found.achieved[0] == pytest.approx(0.01, abs=4 * (2 * 0.01 / 40000) ** 0.5)
    assert found.achieved[1] < found.achieved[0] < found.achieved[2]
    assert found.median_s() is None
