"""Alignment of a moving vehicle, and the mistakes that it finds."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from inertial_paths import resting
from pydantic import TypeAdapter

from sdr_spoof.aiding import increments
from sdr_spoof.aiding.alignment_fit import MeasuredMotion
from sdr_spoof.aiding.alignment_in_motion import in_motion
from sdr_spoof.aiding.imu import errors, grades
from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.errors import InertialError
from sdr_spoof.scenario.sky.receiver import AnyReceiver

SECONDS = 40
SIGMA_M_S = 0.03
TACTICAL = grades.named("tactical")


@cache
def drive():
    """Ideal increments, true states at whole seconds."""
    table = {"kind": "vehicle", "seed": 5, "stand_s": 0.0, "latitude_deg": 31.2}
    table |= {"longitude_deg": 121.5, "height_m": 20.0}
    path = TypeAdapter(AnyReceiver).validate_python(table).trajectory(120.0)
    log = ideal_increments(path, SECONDS + 1.0, 100.0, start_s=30.0)
    return log, true_states(path, 30.25 + np.arange(SECONDS, dtype=np.float64))


def measured(seed=1, sigma=SIGMA_M_S) -> MeasuredMotion:
    _, truth = drive()
    noise = np.random.default_rng(seed).normal(0.0, sigma, truth.velocity_m_s.shape)
    return MeasuredMotion(None, truth.time_s, truth.position_m, truth.velocity_m_s + noise)


def imu(grade="tactical", seed=1, gyro=None, accelerometer=None):
    log = errors.read(drive()[0], grades.draw(grade, seed)[0]).log
    return replace(
        log,
        rotation_rad=log.rotation_rad if gyro is None else log.rotation_rad @ gyro.T,
        velocity_m_s=log.velocity_m_s
        if accelerometer is None
        else log.velocity_m_s @ accelerometer.T,
    )


def off(found) -> np.ndarray:
    error = found.state.attitude_rad[0] - drive()[1].attitude_rad[-1]
    return (error + np.pi) % (2 * np.pi) - np.pi


def test_ideal_increments_give_the_attitude():
    found = in_motion(drive()[0], measured(sigma=0.0), grades.named("n1"))
    assert found.state.time_s[0] == pytest.approx(drive()[1].time_s[-1])
    assert np.abs(off(found)).max() < 2e-4


@pytest.mark.parametrize("grade", ["tactical", "industrial"])
def test_errors_are_as_large_as_stated(grade):
    squares, runs = np.zeros(3), 40
    for seed in range(runs):
        found = in_motion(
            imu(grade, seed),
            measured(seed),
            grades.named(grade),
            velocity_sigma_m_s=SIGMA_M_S,
            largest_heading_sigma_rad=0.5,
        )
        squares += off(found) ** 2 / runs
    heading = np.sqrt(squares[0])
    assert 0.4 < heading / found.sigma.attitude_rad[2] < 1.5


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"accelerometer": np.eye(3) / 9.80665}, "in g: multiply by 9.80665"),
        ({"gyro": np.degrees(np.eye(3))}, "in degrees: multiply by pi/180"),
        ({"gyro": np.radians(np.eye(3))}, "multiply the gyros by 180/pi"),
        ({"gyro": np.diag([1.0, 1, -1])}, r"with gyro axes \(x, y, -z\) they do"),
        ({"gyro": np.eye(3)[[1, 0, 2]]}, r"with gyro axes \(y, x, z\) they do"),
        ({"gyro": np.eye(3)[[0, 2, 1]]}, r"with gyro axes \(x, z, y\) they do"),
        ({"accelerometer": np.diag([1.0, 1, -1])}, r"with accelerometer axes \(x, y, -z\) they"),
        ({"accelerometer": np.eye(3)[[1, 0, 2]]}, r"with accelerometer axes \(y, x, z\) they"),
    ],
)
def test_mistaken_units_and_axes_are_named(change, message):
    with pytest.raises(InertialError, match=message):
        in_motion(imu(**change), measured(), TACTICAL)


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        (np.diag([1.0, -1, -1]), r"seem to be \(x, -y, -z\) of it"),
        (np.diag([-1.0, -1, 1]), r"seem to be \(-x, -y, z\) of it"),
        (np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]]), r"seem to be \(y, x, -z\) of it"),
    ],
)
def test_a_turned_imu_is_named(axes, message):
    turned = imu(gyro=axes, accelerometer=axes)
    with pytest.raises(InertialError, match=message):
        in_motion(turned, measured(), TACTICAL)
    found = in_motion(turned, measured(), TACTICAL, forward=False, largest_heading_sigma_rad=0.2)
    assert found.method == "in motion over 39 s"


def test_clocks_that_are_apart():
    late = replace(measured(), time_s=measured().time_s + 3600.0)
    with pytest.raises(InertialError, match="do their clocks agree"):
        in_motion(imu(), late, TACTICAL)
    slightly = replace(measured(), time_s=measured().time_s - 2.0)
    with pytest.raises(InertialError, match="are the clocks of both apart"):
        in_motion(imu(), slightly, TACTICAL)


def test_other_input_that_is_refused():
    motion = measured()
    motion.velocity_m_s[3] = np.nan
    with pytest.raises(InertialError, match="leave such epochs out"):
        in_motion(imu(), motion, TACTICAL)
    log = imu()
    keep = np.r_[0:1000, 1500 : len(log.time_s)]
    holed = replace(
        log,
        time_s=log.time_s[keep],
        rotation_rad=log.rotation_rad[keep],
        velocity_m_s=log.velocity_m_s[keep],
    )
    with pytest.raises(InertialError, match=r"misses 5.000 s at 40.000 s"):
        in_motion(holed, measured(), TACTICAL)


def test_motion_that_does_not_tell_the_heading():
    still = measured(sigma=0.0)
    start = resting(time_s=30.0)
    log = increments.at_rest(start, 41.0)
    motion = replace(
        still,
        position_m=np.tile(start.position_m, (SECONDS, 1)),
        velocity_m_s=np.zeros((SECONDS, 3)),
    )
    with pytest.raises(InertialError, match="take longer, with turns"):
        in_motion(log, motion, TACTICAL)
