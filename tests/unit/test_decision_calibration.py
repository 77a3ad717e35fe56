"""Thresholds of rules: against closed forms, each other, laws that are not normal; the cache."""

import numpy as np
import pytest

from sdr_spoof import decision
from sdr_spoof.decision import calibration, threshold_cache
from sdr_spoof.decision.calibration import achieved, independent_threshold, threshold_for
from sdr_spoof.decision.laws import NORMAL, Law
from sdr_spoof.errors import ConfigError

SLOW_HZ = 0.1
"""360 samples an hour: quick to simulate."""


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SDR_SPOOF_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(threshold_cache, "_here", {})
    monkeypatch.setattr(calibration, "RUNS", 2000)
    return tmp_path / "cache"


@pytest.mark.parametrize("per_hour", [1e-2, 1e-6])
def test_independent_tests_have_their_closed_form(per_hour):
    wanted = independent_threshold(per_hour, SLOW_HZ)
    found = threshold_for(decision.find("threshold"), per_hour, rate_hz=SLOW_HZ)
    assert found == pytest.approx(wanted, abs=0.05)
    squares = threshold_for(decision.find("chi-square"), per_hour, rate_hz=SLOW_HZ)
    assert squares**0.5 == pytest.approx(wanted, abs=0.05)


@pytest.mark.parametrize("name", ["cusum", "glr-windows", "sprt-classic"])
def test_rare_alarms_are_as_exact_as_common_ones(name):
    rule = decision.find(name)
    thresholds = [threshold_for(rule, p, rate_hz=SLOW_HZ) for p in (1e-3, 1e-6)]
    # Log-likelihood: a thousandfold rarer is ln 1000 further, but for slow terms.
    assert thresholds[1] - thresholds[0] == pytest.approx(np.log(1e3), abs=0.6)
    found = achieved(rule, thresholds[1], rate_hz=SLOW_HZ, runs=1000)
    assert found.method == "importance sampling"
    assert found.low < found.probability < found.high
    assert found.probability == pytest.approx(1e-6, rel=0.35)


def test_a_faster_rate_tests_more():
    rule = decision.find("cusum")
    slow, fast = (threshold_for(rule, 1e-3, rate_hz=rate) for rate in (SLOW_HZ, 10 * SLOW_HZ))
    assert fast - slow == pytest.approx(np.log(10.0), abs=0.3)


def test_coloured_samples_alarm_far_more_often():
    rule = decision.find("cusum")
    threshold = threshold_for(rule, 1e-2, rate_hz=SLOW_HZ)
    found = achieved(rule, threshold, rate_hz=SLOW_HZ, law=Law("ar1", 0.9), runs=2000)
    assert found.probability > 0.5
    assert found.method == "plain simulation"


def test_another_law_is_simulated_plainly():
    rule, law = decision.find("t-test").with_(variance="known"), Law("ma1", -1.0)
    white = threshold_for(rule, 0.05, rate_hz=SLOW_HZ)
    threshold = threshold_for(rule, 0.05, rate_hz=SLOW_HZ, law=law)
    # The mean of K differences of white noise falls as 1 / K, not as its root.
    assert threshold == pytest.approx(white / 10**0.5, rel=0.12)
    found = achieved(rule, threshold, rate_hz=SLOW_HZ, law=law, runs=8000)
    assert found.low < 0.05 * 1.1 and found.high > 0.05 * 0.9
    with pytest.raises(ConfigError, match="ask for at least"):
        threshold_for(rule, 1e-9, law=law)
    with pytest.raises(ConfigError, match="ask for one between"):
        threshold_for(decision.find("cusum"), 1e-15)


@pytest.mark.parametrize("law", [Law("ar1", 0.7), Law("ma1", -0.8), Law("student", 5.0), NORMAL])
def test_laws_have_unit_variance_and_their_memory(law):
    z = law.draw(np.random.default_rng(1), (2000, 50))
    assert z.mean() == pytest.approx(0.0, abs=0.03)
    assert z.var() == pytest.approx(1.0, abs=0.06)
    assert z[:, 0].var() == pytest.approx(1.0, abs=0.25)
    memory = float((z[:, 1:] * z[:, :-1]).mean())
    wanted = {"ar1": 0.7, "ma1": -0.8 / 1.64}.get(law.name, 0.0)
    assert memory == pytest.approx(wanted, abs=0.04)


@pytest.mark.parametrize("law", [("cauchy", 0.0), ("ar1", 1.0), ("student", 2.0)])
def test_bad_laws_are_refused(law):
    with pytest.raises(ConfigError, match="law"):
        Law(*law)


def test_bad_wishes_are_refused():
    rule = decision.find("cusum")
    for per_hour, rate in ((0.0, 1.0), (1.0, 1.0), (0.1, 0.0)):
        with pytest.raises(ConfigError, match="cannot calibrate"):
            threshold_for(rule, per_hour, rate_hz=rate)
    with pytest.raises(ConfigError, match="must be at least"):
        rule.with_(shift=0.0)
    with pytest.raises(ConfigError, match="unexpected keyword"):
        rule.with_(windows=(1,))


def test_thresholds_are_kept_and_read_back(own_cache, monkeypatch):
    rule = decision.find("cusum").with_(shift=1.2)
    first = threshold_for(rule, 2e-3)
    (file,) = (own_cache / "thresholds").iterdir()
    monkeypatch.setattr(threshold_cache, "_here", {})
    monkeypatch.setattr(calibration, "simulated", lambda *_: [7.0] * calibration.LOG10_P.size)
    assert threshold_for(rule, 2e-3) == first
    monkeypatch.setattr(threshold_cache, "_here", {})
    file.write_text("broken")
    assert threshold_for(rule, 2e-3) == 7.0
    assert "7.0" in file.read_text()


def test_a_cache_that_cannot_be_written_is_no_error(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SDR_SPOOF_CACHE", str(tmp_path / "file"))
    monkeypatch.setattr(calibration, "simulated", lambda *_: [7.0] * calibration.LOG10_P.size)
    assert threshold_for(decision.find("cusum").with_(shift=1.3), 3e-3) == 7.0


def test_the_table_that_comes_along_is_what_would_be_simulated(monkeypatch):
    monkeypatch.setattr(calibration, "RUNS", 4000)
    rule = decision.find("improved-sprt")
    key = calibration.key_of(rule, calibration.LONGEST)
    made = calibration.simulated(rule)
    np.testing.assert_allclose(threshold_cache.shipped()[key], made, atol=1e-3)
