"""Sequential rules on the series of detectors, pre-whitening, and when a rule refuses."""

import dataclasses

import numpy as np
import pytest
from simulated_tracks import Attack, Satellite, simulate_log

from sdr_spoof import decision
from sdr_spoof.decision import Decision, Refusal
from sdr_spoof.decision.sampled import independent
from sdr_spoof.decision.whitening import autocorrelation, fit, shift_left, whiten
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.verdict import detect

SEQUENTIAL = [n for n in decision.RULES if n not in ("threshold", "improved-sprt-as-printed")]


@pytest.fixture(autouse=True, scope="module")
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SDR_SPOOF_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def series_of(z, **changes):
    """A series of independent samples, one a second."""
    n = z.size
    time_s = np.arange(1.0, n + 1.0)
    series = StatisticSeries(
        detector="test",
        system="BeiDou",
        prn=1,
        unit="m",
        time_s=time_s,
        value=3.0 * z,
        sigma=np.full(n, 3.0),
        sigma_thermal=np.full(n, 3.0),
        segment=np.zeros(n, np.int64),
        window_s=1.0,
        trace_time_s=time_s - 0.5,
        trace=3.0 * z,
        trace_unit="m",
        trace_segment=np.zeros(n, np.int64),
        notes=(),
    )
    return dataclasses.replace(series, **changes)


def config_of(rule):
    return DetectionConfig(rule=rule, false_alarms_per_hour=1e-3)


def noise(n, seed=1):
    return np.random.default_rng(seed).standard_normal(n)


@pytest.mark.parametrize("rule", SEQUENTIAL)
def test_every_rule_decides_on_a_series(rule):
    z = noise(400)
    assert decision.decide(series_of(z), config_of(rule)) is None
    z[250:] += 5.0
    found = decision.decide(series_of(z), config_of(rule))
    assert isinstance(found, Decision)
    assert 250.0 < found.alarm_s < 290.0
    assert found.onset_s == pytest.approx(250.5, abs=3.0)
    assert found.statistic > found.threshold
    assert found.log10_p < -6.0


def test_a_coloured_series_is_refused_or_whitened():
    rng = np.random.default_rng(2)
    white = rng.standard_normal(400)
    coloured = white.copy()
    for k in range(1, 400):
        coloured[k] = 0.6 * coloured[k - 1] + 0.8 * white[k]
    assert decision.decide(series_of(coloured), config_of("cusum")) is None
    slow = np.convolve(noise(500), np.full(8, 8**-0.5), "valid")
    found = decision.decide(series_of(slow), config_of("cusum"))
    assert isinstance(found, Refusal)
    assert "cusum" in found.reason
    loud = decision.decide(series_of(3.0 * white), config_of("cusum"))
    assert isinstance(loud, Refusal)
    assert "as much as their law says" in loud.reason
    few = decision.decide(series_of(white[:15]), config_of("cusum"))
    assert isinstance(few, Refusal)
    assert "20 are needed" in few.reason


def test_whitening_leaves_white_noise_and_less_of_a_shift():
    rng = np.random.default_rng(3)
    rho, n = 0.8, 20_000
    z = rng.standard_normal(n)
    for k in range(1, n):
        z[k] = rho * z[k - 1] + 0.6 * z[k]
    fitted = fit(z)
    assert fitted.refusal is None
    assert fitted.rho == pytest.approx(rho, abs=4 * 0.6 / n**0.5)
    white = whiten(z, fitted.rho)
    assert np.abs(autocorrelation(white, 5)).max() < 4 / n**0.5
    assert white.var() == pytest.approx(1.0, abs=0.06)
    assert whiten(np.full(5, 2.0), rho)[-1] == pytest.approx(2.0 * shift_left(rho))


def test_few_good_samples_are_refused():
    z = np.random.default_rng(4).standard_normal((2000, 60))
    refused = sum(fit(row).refusal is not None for row in z)
    assert refused <= 12


def test_independent_samples_of_overlapping_windows():
    z = noise(1000)
    means = np.convolve(z, np.full(10, 0.1), "valid")
    n = means.size
    ones, zeros = np.ones(n), np.zeros(n, np.int64)
    series = series_of(means)
    fast = dataclasses.replace(
        series,
        time_s=0.1 * np.arange(10, 10 + n),
        value=means,
        sigma=ones / 10**0.5,
        sigma_thermal=ones,
        segment=zeros,
    )
    samples = independent(fast, 1e-3)
    assert samples.z.size == 100
    np.testing.assert_allclose(samples.z, z[:1000].reshape(100, 10).mean(1) * 10**0.5)


def test_the_largest_of_many_tests_counts_less():
    z = np.abs(noise(4000)).reshape(1000, 4).max(1) * np.sign(noise(1000, 5))
    # A threshold for 4 independent tests a second: 1e-3 an hour in 14400 tests.
    from scipy.stats import norm  # noqa: PLC0415

    sigmas = float(norm.isf(0.5 * 1e-3 / 14400))
    samples = independent(series_of(z, threshold_sigmas=sigmas), 1e-3)
    assert samples.z.mean() == pytest.approx(0.0, abs=4 / 1000**0.5)
    assert samples.z.std() == pytest.approx(1.0, abs=4 / 2000**0.5)


@pytest.mark.parametrize("rule", ["cusum", "glr-windows", "improved-sprt", "sprt-classic"])
def test_rules_on_a_detector_of_tracks(rule):
    config = DetectionConfig(detectors=("phase_difference_rate",), rule=rule)
    config = config.model_copy(update={"threshold_model": "thermal"})
    attack = Attack(start_s=35.0, drag_hz=0.3)
    log = simulate_log(Satellite(23, attack=attack), Satellite(24), duration_s=50.0)
    attacked, clean = detect(log, config).satellites
    assert attacked.verdict == "spoofed"
    (alarm,) = attacked.alarms
    assert 35.0 < alarm.alarm_s < 43.0
    assert clean.verdict == "clean"


def test_a_refusal_is_no_support_and_is_said():
    config = DetectionConfig(detectors=("phase_difference_rate",), rule="cusum")
    satellite = detect(simulate_log(Satellite()), config).satellites[0]
    assert satellite.verdict == "not enough support"
    assert "does not judge" in satellite.reason
