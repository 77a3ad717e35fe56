"""Errors of inertial sensors, and grades of them."""

import numpy as np
import pytest

from sdr_spoof.aiding.imu.errors import ImuErrors, SensorErrors, read
from sdr_spoof.aiding.imu.grades import DEG_HOUR, GRADES, MICRO_G, draw, named
from sdr_spoof.aiding.records import ImuLog
from sdr_spoof.errors import ConfigError

RATE_HZ = 100.0


def still(rows):
    return ImuLog(
        None,
        np.arange(1, rows + 1) / RATE_HZ,
        1 / RATE_HZ,
        np.zeros((rows, 3)),
        np.tile([0.0, 0.0, -9.8 / RATE_HZ], (rows, 1)),
    )


def test_no_errors_leave_the_truth():
    log = still(100)
    got = read(log, ImuErrors())
    np.testing.assert_array_equal(got.log.velocity_m_s, log.velocity_m_s)
    np.testing.assert_array_equal(got.gyro_bias_rad_s, 0.0)


def test_every_term_has_its_place():
    gyro = SensorErrors(bias=(1e-4, 0.0, 0.0))
    accelerometer = SensorErrors(
        scale=(0.0, 0.0, 0.01), misalignment_rad=(0.0, 0.001, 0.0, 0.0, 0.0, 0.0), limit=9.85
    )
    got = read(still(3), ImuErrors(gyro, accelerometer))
    np.testing.assert_allclose(got.log.rotation_rad[:, 0], 1e-6)
    np.testing.assert_allclose(got.log.velocity_m_s[:, 0], -9.8e-5)
    np.testing.assert_allclose(got.log.velocity_m_s[:, 2], -9.85e-2)
    np.testing.assert_allclose(got.gyro_bias_rad_s, [[1e-4, 0, 0]] * 3)


@pytest.mark.parametrize("name", GRADES)
def test_pieces_of_a_run_are_the_run(name):
    errors = draw(name, seed=3, runs=2)[1]
    log = still(500)
    whole = read(log, errors)
    for cut in (1, 64, 333):
        rest = ImuLog(
            None,
            log.time_s[cut:],
            log.interval_s,
            *(x[cut:] for x in (log.rotation_rad, log.velocity_m_s)),
        )
        piece = read(rest, errors, first=cut)
        np.testing.assert_array_equal(piece.log.rotation_rad, whole.log.rotation_rad[cut:])
        np.testing.assert_array_equal(
            piece.accelerometer_bias_m_s2, whole.accelerometer_bias_m_s2[cut:]
        )


@pytest.mark.parametrize("name", [n for n, g in GRADES.items() if g.gyro.density])
def test_random_walks_have_their_size(name):
    grade = named(name)
    sigma = grade.gyro.density, grade.accelerometer.density
    errors = ImuErrors(SensorErrors(density=sigma[0]), SensorErrors(density=sigma[1]), seed=1)
    log = still(40_000)
    got = read(log, errors).log
    for noise, size in (
        (got.rotation_rad - log.rotation_rad, sigma[0]),
        (got.velocity_m_s - log.velocity_m_s, sigma[1]),
    ):
        seconds = noise.reshape(-1, 100, 3).sum(axis=1)
        relative = (seconds**2).mean() / size**2 - 1
        assert abs(relative) < 4 * np.sqrt(2 / seconds.size)


def test_draws_are_of_the_grade_and_of_the_run():
    runs = draw("tactical", seed=5, runs=1000)
    bias = np.array([r.accelerometer.bias for r in runs])
    relative = (bias**2).mean() / (1000 * MICRO_G) ** 2 - 1
    assert abs(relative) < 4 * np.sqrt(2 / bias.size)
    assert draw("tactical", seed=5, runs=3) == runs[:3]
    assert runs[0] != runs[1]


def test_published_biases_have_random_signs():
    bias = np.array([r.gyro.bias for r in draw("n1", seed=2, runs=400)])
    np.testing.assert_allclose(abs(bias), 0.1 * DEG_HOUR)
    assert (abs(np.sign(bias).mean(axis=0)) < 4 / np.sqrt(400)).all()
    n2 = np.array([r.gyro.bias for r in draw("n2", seed=2, runs=400)])
    np.testing.assert_allclose(n2, 5 * bias)


def test_an_unknown_grade_names_the_known():
    with pytest.raises(ConfigError, match="navigation, tactical"):
        draw("best", seed=0)
