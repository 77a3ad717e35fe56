"""The threshold that is trained on the first part of a series."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t

from sdr_spoof import decision
from sdr_spoof.decision import trained_threshold
from sdr_spoof.decision.record import Decision, Refusal
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries

EPOCHS, TRAINING = 400, 60
CONFIG = DetectionConfig(
    rule="trained-threshold", rule_training_s=60.0, false_alarm_probability=1e-6
)


def series(value, **changes):
    time_s = np.arange(1.0, value.size + 1)
    made = StatisticSeries(
        detector="d",
        system="",
        prn=0,
        unit="m/s",
        time_s=time_s,
        value=value,
        sigma=np.ones(value.size),
        sigma_thermal=np.ones(value.size),
        segment=np.zeros(value.size, dtype=np.int64),
        window_s=1.0,
        trace_time_s=time_s,
        trace=value,
        trace_unit="m/s",
        trace_segment=np.zeros(value.size, dtype=np.int64),
        notes=(),
    )
    return replace(made, **changes)


@pytest.mark.parametrize("mean", ["trained", "zero"])
def test_the_law_is_students(mean):
    rule = decision.find("trained-threshold").with_(training=12, mean=mean)
    z = 3.0 * np.random.default_rng(1).standard_normal((20000, 13))
    z += 5.0 if mean == "trained" else 0.0
    size = rule.run(z)[:, -1]
    for wanted in (0.2, 0.01):
        share = np.mean(size > t.isf(wanted / 2, rule.parameters.freedom))
        assert share == pytest.approx(wanted, abs=4 * (wanted / len(z)) ** 0.5)


def test_an_offset_and_an_unknown_scale_are_learned():
    value = 0.3 + 0.01 * np.random.default_rng(2).standard_normal(EPOCHS)
    assert decision.decide(series(value), CONFIG) is None
    value[250:] += 0.1
    found = decision.decide(series(value), CONFIG)
    assert isinstance(found, Decision)
    assert found.alarm_s == 251.0
    assert found.onset_s == pytest.approx(251.0, abs=3.0)
    assert found.statistic > found.threshold
    assert found.log10_p < -6.0


def test_the_mean_may_be_known():
    value = 0.5 + 0.1 * np.random.default_rng(3).standard_normal(EPOCHS)
    config = CONFIG.model_copy(update={"rule_training_mean": "zero"})
    # The offset counts as scatter: the threshold is half a unit wide and more.
    value[200:] += 0.6
    assert decision.decide(series(value), config) is None
    assert isinstance(decision.decide(series(value), CONFIG), Decision)


def test_it_is_blind_to_an_attack_within_its_training_but_not_to_its_end():
    value = 0.01 * np.random.default_rng(4).standard_normal(EPOCHS)
    value[:300] += 0.1
    found = decision.decide(series(value), CONFIG)
    assert isinstance(found, Decision)
    assert found.alarm_s == 301.0


def test_a_drift_breaks_it():
    noise = 0.01 * np.random.default_rng(5).standard_normal(EPOCHS)
    drift = 1e-6 * np.arange(EPOCHS) ** 2.0
    assert decision.decide(series(noise), CONFIG) is None
    assert isinstance(decision.decide(series(noise + drift), CONFIG), Decision)


def test_too_little_training_is_refused():
    value = np.random.default_rng(6).standard_normal(EPOCHS)
    found = decision.decide(series(value, window_s=10.0), CONFIG)
    assert isinstance(found, Refusal)
    assert "6 independent samples" in found.reason
    assert decision.decide(series(value[:0]), CONFIG) is None
    assert decision.decide(series(value[:30]), CONFIG) is None


def test_the_probability_is_the_detectors_where_it_states_one():
    value = np.random.default_rng(7).standard_normal(EPOCHS)
    value[300] = 4.2
    assert decision.decide(series(value), CONFIG) is None
    found = decision.decide(series(value, threshold_sigmas=3.8), CONFIG)
    assert isinstance(found, Decision)
    assert found.threshold == pytest.approx(t.isf(7.23e-5, TRAINING - 1), rel=0.01)
    assert trained_threshold.RULE.name == CONFIG.rule
