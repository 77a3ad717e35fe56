"""The study of rate consistency with an INS: drift, false alarms, tests, drags, errata."""

import numpy as np
import pytest

from sdr_spoof.progress import silent
from sdr_spoof.reproduce import ins_rate
from sdr_spoof.reproduce.ins_rate import (
    drag_runs,
    drag_section,
    drift_section,
    errata,
    false_alarms,
    flight_section,
    published,
    signs,
    simulated,
    strapdown_runs,
    tests_section,
)
from sdr_spoof.reproduce.study import Effort

QUICK = Effort(runs=10, quick=True)


@pytest.fixture
def few(monkeypatch):
    """Six random flights."""
    monkeypatch.setattr(false_alarms, "QUICK_FLIGHTS", 6)


def test_linear_drift_is_that_of_schuler():
    gyro, accelerometer = drift_section.linear_standing()
    at = list(published.STATIC_S)
    np.testing.assert_allclose(gyro[at], published.GYRO_M_S, rtol=0.01)
    np.testing.assert_allclose(accelerometer[at], published.ACCELEROMETER_M_S, rtol=0.01)
    assert drift_section.compass_deg() == pytest.approx(0.46, abs=0.005)


def test_linear_drift_is_that_of_the_strapdown_computer():
    flown = strapdown_runs.fly(0, simulated.BIAS_SEED)
    assert np.abs(flown.velocity_m_s[0]).max() < drift_section.CLOSURE_M_S
    assert np.abs(flown.position_m[0]).max() < drift_section.CLOSURE_M
    assert (drift_section.differences([flown]) < 0.01).all()


def test_false_alarms_of_random_flights(few):
    section = false_alarms.section(QUICK, silent)
    printed = [n for n in section.numbers if n.name.startswith("printed")]
    assert len(printed) == 8
    assert all(n.met for n in printed)
    for row in section.tables[0].rows:
        cells = dict(zip(section.tables[0].columns, row, strict=True))
        for axis in published.NAMES:
            reference = cells[f"another simulation, {axis}"]
            if reference is not None:
                allowed = 4 * cells[f"standard error, {axis}"] + 3.0
                assert cells[f"{axis} (%)"] == pytest.approx(reference, abs=allowed), row


def test_samples_and_thresholds_of_the_tests(few):
    numbers = {n.name: n for n in tests_section.section(QUICK, silent).numbers}
    assert all(n.met for name, n in numbers.items() if name.startswith(("k_", "single", "sigma")))
    assert numbers["k_normal_north"].value == 5
    assert numbers["local_threshold_straight_0.005_n1"].value == pytest.approx(0.0065, rel=0.2)
    assert numbers["local_pd_straight_0.005_n1"].met
    assert numbers["t_test_rejects_north"].value > 85.0


def test_without_biases_the_drag_is_found_as_by_noise_alone():
    flights = simulated.fleet(6).flights
    clean, dragged = signs.shares(flights, np.zeros((1, 6, 6)))
    size = 6 * 99
    assert clean[0] == pytest.approx(0.01, abs=4 * (0.01 * 0.99 / size) ** 0.5 + 0.002)
    assert dragged[0] == pytest.approx(0.25, abs=4 * (0.25 * 0.75 / size) ** 0.5 + 0.01)


def test_the_end_of_an_interval_is_not_its_mean():
    assert flight_section.end_velocity_error() == pytest.approx(1.85, abs=0.01)


def test_a_drag_through_the_strapdown_computer(monkeypatch):
    monkeypatch.setattr(published, "DURATION_S", 200.0)
    monkeypatch.setattr(drag_runs, "LAST_S", 130)
    outcome = drag_runs.fly(drag_runs.Case("n2", (0.1, 0.02), 2, 4, 3), 1)
    drag, local = outcome.drag, outcome.local
    assert drag.delay_s.shape == local.delay_s.shape == (2, 2, 4)
    assert (drag.delay_s[:, 0] <= 3.0).all()
    assert (drag.delay_s[:, 1] <= 10.0).all()
    for found, tested_s in ((drag, 195), (local, 131)):
        assert found.alarms[-1] == found.early == 0
        assert found.hours == pytest.approx(8 * tested_s / 3600, rel=0.02)
    # N2 has drifted little so soon.
    assert (local.delay_s[:, 0][outcome.onset_s[:, 0] >= drag_section.LOCAL_FIRST_S] <= 10.0).all()


def test_rates_of_alarms_have_exact_intervals():
    rate, low, high = drag_section.per_hour(0, 100.0)
    assert (rate, low) == (0.0, 0.0)
    assert high == pytest.approx(0.0369, abs=1e-4)
    assert drag_section.per_hour(3, 100.0)[1:] == pytest.approx((0.00619, 0.0877), rel=0.01)


def test_errata_are_complete():
    titles = " ".join(e.title for e in errata.errata())
    assert len(errata.errata()) == 9
    for word in ("drift", "mean", "below", "spike", "Equation 8", "heading", "Clocks"):
        assert word in titles
    assert ins_rate.STUDY.full_runs == 100
