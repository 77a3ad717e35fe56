"""The published combo-signal model against its printed numbers."""

import numpy as np
import pytest
from scipy.stats import norm

from sdr_spoof.detectors import combo_model as model

T_S, B_HZ, PFA = 0.1, 1.0, 1e-6


def law(reading):
    sigma = model.fll_sigma_hz(model.PUBLISHED_CN0_HZ[reading], T_S, B_HZ)
    return model.difference_sigma_hz(sigma, sigma)


def test_threshold_with_cn0_read_as_a_ratio():
    sigma = law("as_ratio")
    assert float(sigma) == pytest.approx(0.94902, abs=1e-5)
    threshold = float(model.threshold_for_pfa_hz(sigma, PFA))
    assert threshold == pytest.approx(4.5111, abs=1e-3)
    # What the paper prints is this plus the difference of the carriers, in MHz.
    assert threshold + (1575.42 - 1561.098) == pytest.approx(18.83, abs=5e-3)


def test_threshold_with_cn0_read_as_dbhz():
    assert float(model.threshold_for_pfa_hz(law("as_dbhz"), PFA)) == pytest.approx(0.6800, abs=1e-3)


DRAG_PD = [0.6196, 0.7326, 0.8255, 0.8949, 0.9417, 0.9703, 0.9861, 0.9941, 0.9977, 0.9992]
ETA_PD = [0.7782, 0.8399, 0.8854, 0.9182, 0.9417, 0.9583, 0.9700, 0.9783, 0.9842, 0.9884]


@pytest.mark.parametrize(
    ("drag_hz", "eta", "expected"),
    [
        (np.arange(8.0, 12.6, 0.5), 1.5, DRAG_PD),
        (10.0, np.arange(1.1, 2.01, 0.1), ETA_PD),
    ],
)
def test_published_detection_probabilities(drag_hz, eta, expected):
    shift = model.capture_rate_small_angle_hz(drag_hz, eta)
    for reading, wanted in (("as_ratio", expected), ("as_dbhz", np.ones(10))):
        sigma = law(reading)
        threshold = model.threshold_for_pfa_hz(sigma, PFA)
        got = model.detection_probability(shift, sigma, threshold)
        np.testing.assert_allclose(got, wanted, atol=1e-3)


def test_likelihood_ratio_threshold_is_where_the_densities_have_that_ratio():
    sigma, shift, ratio = 0.95, 6.0, 20.0
    x = float(model.threshold_for_likelihood_ratio_hz(sigma, ratio, shift))
    assert norm.pdf(x, shift, sigma) / norm.pdf(x, 0, sigma) == pytest.approx(ratio)


def test_two_sided_threshold_splits_the_false_alarms():
    threshold = float(model.threshold_for_pfa_hz(2.0, 0.01, two_sided=True))
    assert 2 * norm.sf(threshold / 2.0) == pytest.approx(0.01)
    both = model.detection_probability(0.0, 2.0, threshold, two_sided=True)
    assert float(both) == pytest.approx(0.01)


@pytest.mark.parametrize("eta", [0.6, 1.5, 3.0])
def test_capture_models_against_the_sum_of_two_phasors(eta):
    drag_hz = 2.0
    time = np.arange(0, 50, 1e-3)
    phase = np.unwrap(np.angle(1 + eta * np.exp(2j * np.pi * drag_hz * time))) / (2 * np.pi)
    small = np.diff(phase)[:5].mean() / 1e-3
    assert small == pytest.approx(float(model.capture_rate_small_angle_hz(drag_hz, eta)), rel=1e-3)
    assert phase[-1] / time[-1] == pytest.approx(
        float(model.capture_rate_mean_hz(drag_hz, eta)), abs=0.02
    )
