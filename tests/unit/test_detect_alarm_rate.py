"""Jump and slope over sliding windows: law, measured noise, and alarms per hour, by simulation."""

import numpy as np
import pytest
from scipy.stats import f as f_law
from scipy.stats import norm

from sdr_spoof.detectors import alarm_rate
from sdr_spoof.detectors.alarm_rate import (
    alarms_per_hour,
    correlation_loss,
    mean_alarms_per_hour,
    mean_threshold_sigmas,
    overshoot,
    threshold_sigmas,
)
from sdr_spoof.detectors.jump_slope import Plan, deviates
from sdr_spoof.detectors.noise_level import noise_level


def white(rows, seed):
    return np.random.default_rng(seed).standard_normal(rows)


def clumps(deviate, threshold, apart):
    at = np.flatnonzero(np.abs(deviate) > threshold)
    return int(at.size > 0) + int(np.count_nonzero(np.diff(at) > apart))


def test_deviates_are_the_least_squares_statistic():
    # One window by the book: level of 60 rows before, fit of mean and slope in 20, noise known.
    values = white(2000, 1)
    plan = Plan(0.1, (20,), 60, 60, 10, 0.0)
    k = 1500
    window, before = values[k - 19 : k + 1], values[k - 79 : k - 19]
    slope, mean = np.polyfit(np.arange(20) - 9.5, window, 1)
    level = noise_level(values, np.ones(2000), 10, 60, 60)
    variance, freedom = (float(v[0]) for v in level.before(np.array([k - 19]), np.ones(1)))
    energy = (mean - before.mean()) ** 2 / (1 / 20 + 1 / 60) + slope**2 * 20 * 399 / 12
    p = (1 + energy / variance / freedom) ** (-freedom / 2)
    expected = np.sign(mean - before.mean() + 10 * slope) * norm.isf(p / 2)
    assert deviates(values, np.ones(2000), plan)[k] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("window", "reference", "group"), [(10, 1000, 10), (25, 150, 5)])
def test_law_of_one_test(window, reference, group):
    # The noise is measured, so that the deviate is normal all the same; every window-th test.
    plan = Plan(0.2, (window,), reference, reference, group, 0.0)
    rows = 200_000
    deviate = deviates(white(rows, 2), np.ones(rows), plan)
    tests = np.abs(deviate[np.isfinite(deviate)][::window])
    for pfa in (0.1, 0.01):
        crossed = np.mean(tests > norm.isf(pfa / 2))
        standard_error = np.sqrt(pfa * (1 - pfa) / tests.size)
        # References overlap and the law of a median is slightly too wide: up to a tenth fewer.
        assert -4 * standard_error - 0.1 * pfa < crossed - pfa < 4 * standard_error


def test_noise_level_is_free_of_bias_and_as_sure_as_it_says():
    level = noise_level(white(400_000, 3), np.ones(400_000), 10, 1000, 1000)
    alone = level.variance[100::100]  # one hundred groups each: no two share any
    freedom = float(level.freedom[-1])
    assert freedom == pytest.approx(4.75 * 100, rel=0.02)
    spread = np.sqrt(2 / freedom)
    assert np.mean(alone) == pytest.approx(1.0, abs=4 * spread / np.sqrt(alone.size))
    assert np.std(alone) == pytest.approx(spread, rel=4 / np.sqrt(2 * alone.size))


def test_noise_level_ignores_what_disturbs_less_than_half():
    values = white(20_000, 4)
    disturbed = values + 50.0 * np.sin(np.arange(20_000) / 3.0) * (np.arange(20_000) % 1000 < 300)
    clean, other = (
        noise_level(v, np.ones(20_000), 10, 1000, 1000).variance[150:] for v in (values, disturbed)
    )
    assert np.median(other) < 2.0 * np.median(clean)


def test_neighbouring_tests_are_correlated_as_the_formula_says():
    deviations = correlation_loss(20, 60)
    # Along the jump: edges of 1/n, 1/n + 1/m and 1/m; along the slope: 3 / n.
    jump = ((1 / 20) ** 2 + (1 / 20 + 1 / 60) ** 2 + (1 / 60) ** 2) / (2 * (1 / 20 + 1 / 60))
    assert deviations[0] == pytest.approx(jump, rel=1e-9)
    assert deviations[32] == pytest.approx(3 / 20, rel=0.05)
    assert float(overshoot(1e-6)) == pytest.approx(1.0, abs=1e-5)
    assert float(overshoot(30.0)) == pytest.approx(2 / 30**2, rel=0.01)


@pytest.mark.parametrize("window", [10, 100])
def test_alarms_per_hour_of_one_window(window):
    # 2 x 10^6 rows of white noise; clumps are a window apart. The formula is for high thresholds.
    plan, rows, z = Plan(0.01, (window,), 500, 500, 10, 0.0), 1_000_000, 3.3
    found = sum(clumps(deviates(white(rows, s), np.ones(rows), plan), z, window) for s in (5, 6))
    expected = 2 * rows * 0.01 / 3600 * alarms_per_hour(z, (window,), 500, 0.01)
    assert 0.6 * expected < found < expected + 4 * np.sqrt(expected)


def test_alarms_per_hour_of_all_windows_together():
    # The sum over windows is an upper bound: they overlap. 30 h of blocks of 0.2 s.
    plan = Plan.of(0.2, (1.0, 2.0, 5.0, 10.0, 20.0), (5.0, 30.0), 1.0, 0.0)
    rows = 30 * 18_000
    threshold = plan.threshold(20.0)
    found = clumps(deviates(white(rows, 7), np.ones(rows), plan), threshold, 100)
    expected = 30 * 20.0
    assert 0.3 * expected < found < expected


def test_thresholds_follow_the_rate():
    windows = (10, 20, 50, 100, 200, 400)
    for rate, threshold in ((1e-3, 6.125), (1.0, 4.877)):
        found = threshold_sigmas(windows, 1000, 0.01, rate)
        assert found == pytest.approx(threshold, abs=0.001)
        assert alarms_per_hour(found, windows, 1000, 0.01) == pytest.approx(rate, rel=1e-4)
    # 360000 rows an hour and six windows, which amount to fewer independent tests.
    assert 9e5 < alarm_rate.tests_per_hour(6.0, windows, 1000, 0.01) < 6 * 360_000


def test_an_innocent_drift_is_allowed_for():
    rows = np.arange(20_000)
    still = white(20_000, 8)
    drifting = still + 3e-4 * rows  # 0.03 a second: a full sigma within a reference
    plan = Plan.of(0.01, (0.1, 1.0, 4.0), (2.0, 10.0), 0.1, 0.03)
    threshold = plan.threshold(1e-2)
    assert np.nanmax(np.abs(deviates(drifting, np.ones(20_000), plan))) < threshold
    strict = Plan.of(0.01, (0.1, 1.0, 4.0), (2.0, 10.0), 0.1, 0.0)
    assert np.nanmax(np.abs(deviates(drifting, np.ones(20_000), strict))) > threshold


def test_noise_that_rises_with_a_falling_signal_is_expected():
    weak = np.arange(20_000) >= 12_000
    values = white(20_000, 9) * np.where(weak, 4.0, 1.0)
    plan = Plan.of(0.01, (0.1, 1.0, 4.0), (2.0, 10.0), 0.1, 0.0)
    told = np.abs(deviates(values, np.where(weak, 16.0, 1.0), plan))
    assert (
        np.nanmax(told)
        < plan.threshold(1e-2)
        < np.nanmax(np.abs(deviates(values, np.ones(20_000), plan)))
    )


@pytest.mark.parametrize("variance", [False, True])
def test_alarms_per_hour_of_a_mean_and_of_a_variance_against_a_reference(variance):
    # 14 h of white noise, the variance as the normal quantile of its F law; clumps a window apart.
    window, reference, rows, z = 100, 1000, 5_000_000, 3.8
    values = white(rows, 10)
    values = values**2 if variance else values
    total = np.concatenate(([0.0], np.cumsum(values)))
    start = np.arange(reference, rows - window)
    test = (total[start + window] - total[start]) / window
    before = (total[start] - total[start - reference]) / reference
    if variance:
        law = f_law(window, reference)
        beyond = (test / before > law.isf(norm.sf(z))) | (test / before < law.ppf(norm.sf(z)))
    else:
        beyond = np.abs(test - before) > z * np.sqrt(1 / window + 1 / reference)
    found = clumps(beyond.astype(float), 0.5, window)
    expected = rows * 0.01 / 3600 * mean_alarms_per_hour(z, window, reference, 0.01)
    assert abs(found - expected) < 4 * np.sqrt(expected)
    threshold = mean_threshold_sigmas(window, reference, 0.01, 5.0)
    assert mean_alarms_per_hour(threshold, window, reference, 0.01) == pytest.approx(5.0)
    assert mean_threshold_sigmas(window, reference, 0.01, 2.5, sides=1) == threshold
