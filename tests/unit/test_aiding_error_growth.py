"""Standard deviations of an INS by the time since its alignment."""

import numpy as np
import pytest
from inertial_paths import local, rest

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.error_growth import AlignmentSigma, error_growth
from sdr_spoof.aiding.imu import grades

RUNS = 200


def test_it_is_what_runs_of_a_grade_scatter_by():
    log, start = rest(120.0, rate_hz=50.0)
    growth = error_growth(log, start, grades.named("ship-b"), every=1500)
    states = strapdown.navigate_runs(log, start, grades.draw("ship-b", 4, RUNS), every=1500)
    assert np.array_equal(growth.time_s, states.time_s)
    enu = local(states.velocity_m_s[:, 1:])
    found = np.mean(enu**2, axis=0)[:, [1, 0]]
    want = growth.velocity_sigma_m_s[1:, :2] ** 2
    # The biases are signs, not normal numbers: squares scatter less than this allows.
    assert found / want == pytest.approx(np.ones_like(want), abs=4 * np.sqrt(2 / RUNS))
    moved = local(states.position_m[:, -1] - start.position_m)
    ratio = np.mean(moved**2, axis=0)[[1, 0]] / growth.position_sigma_m[-1, :2] ** 2
    assert ratio == pytest.approx(np.ones(2), abs=4 * np.sqrt(2 / RUNS))


def test_it_begins_with_what_the_alignment_left():
    log, start = rest(10.0)
    alignment = AlignmentSigma((1.0, 2.0, 3.0), (0.1, 0.2, 0.3), (1e-3, 2e-3, 3e-3))
    growth = error_growth(log, start, grades.named("n1"), every=100, alignment=alignment)
    assert growth.position_sigma_m[0] == pytest.approx([1.0, 2.0, 3.0])
    assert growth.sigma()[0, 6:] == pytest.approx([1e-3, 2e-3, 3e-3])
    # A tilt of 2 mrad about east lets gravity pull 9.8 mm/s^2 on north.
    want = np.hypot(0.1, 9.797 * 2e-3 * 10)
    assert growth.velocity_sigma_m_s[-1, 0] == pytest.approx(want, rel=0.01)
    assert growth.velocity_covariance.shape == (11, 3, 3)
