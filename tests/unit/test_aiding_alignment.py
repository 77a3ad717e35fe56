"""Alignment at rest and by course, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from inertial_paths import PLACE, rest, resting

from sdr_spoof.aiding import alignment, alignment_checks
from sdr_spoof.aiding.imu import errors, grades
from sdr_spoof.aiding.imu.errors import ImuErrors, SensorErrors
from sdr_spoof.errors import InertialError
from sdr_spoof.nav.geodesy import enu_matrix

ATTITUDE = (0.7, 0.05, -0.08)
POSITION_M = resting().position_m[0]
NAVIGATION = grades.named("navigation")


def log_of(errors_: ImuErrors | None = None, duration_s=60.0):
    ideal, _ = rest(duration_s, attitude_rad=ATTITUDE)
    return ideal if errors_ is None else errors.read(ideal, errors_).log


def mapped(log, gyro=1.0, accelerometer=1.0):
    """The log as an IMU with other axes or units gives it."""
    return replace(
        log,
        rotation_rad=log.rotation_rad @ (gyro * np.eye(3) if np.ndim(gyro) == 0 else gyro).T,
        velocity_m_s=log.velocity_m_s
        @ (accelerometer * np.eye(3) if np.ndim(accelerometer) == 0 else accelerometer).T,
    )


def test_an_ideal_imu_finds_level_and_north():
    found = alignment.at_rest(log_of(), POSITION_M, NAVIGATION)
    assert found.state.attitude_rad[0] == pytest.approx(ATTITUDE, abs=1e-9)
    assert found.state.time_s[0] == pytest.approx(60.0)
    assert found.method == "levelled, gyro-compassed over 60 s at rest"
    chosen = alignment.at_rest(log_of(), POSITION_M, NAVIGATION, first_s=10.0, last_s=30.0)
    assert chosen.state.time_s[0] == pytest.approx(30.0)


@pytest.mark.parametrize("name", ["navigation", "n1", "ship-a"])
def test_errors_are_as_large_as_stated(name):
    grade, runs = grades.named(name), 200
    ideal, _ = rest(20.0, attitude_rad=ATTITUDE, rate_hz=50.0)
    off = []
    for one in grades.draw(grade, 5, runs):
        found = alignment.at_rest(
            errors.read(ideal, one).log, POSITION_M, grade, largest_heading_sigma_rad=1.0
        )
        off.append(found.state.attitude_rad[0] - ATTITUDE)
    heading = np.sqrt(np.mean(np.square(off), axis=0))[0]
    # Signs of biases: a heading error is their sum along east, so that it scatters less.
    assert heading == pytest.approx(found.sigma.attitude_rad[2], rel=0.3)
    tilts = np.sqrt(np.mean(np.square(off), axis=0))[1:]
    assert tilts == pytest.approx(np.full(2, found.sigma.attitude_rad[0]), rel=0.3)


def test_published_heading_error_of_n1():
    """0.1 deg/h against the Earth's turn at 34 degrees: 0.46 degrees."""
    found = alignment.at_rest(log_of(), POSITION_M, grades.named("n1"))
    assert np.degrees(found.sigma.attitude_rad[2]) == pytest.approx(0.46, abs=0.01)
    assert found.sigma.attitude_rad[0] == pytest.approx(10e-6, rel=0.01)


def test_a_heading_may_be_given():
    grade = grades.named("mems")
    log = log_of(grades.draw(grade, 1)[0])
    with pytest.raises(InertialError, match="grade 'mems' find north"):
        alignment.at_rest(log, POSITION_M, grade)
    found = alignment.at_rest(log, POSITION_M, grade, heading_rad=0.7, heading_sigma_rad=0.02)
    assert found.state.attitude_rad[0] == pytest.approx(ATTITUDE, abs=0.03)
    assert found.sigma.attitude_rad[2] == 0.02


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"accelerometer": 1 / 9.80665}, "in g: multiply by 9.80665"),
        ({"accelerometer": 9.80665}, "divide by 9.80665"),
        ({"accelerometer": 1000 / 9.80665}, "in mg"),
        ({"accelerometer": 1 / 0.3048}, "feet"),
        ({"accelerometer": 100.0}, "rates seem to be taken as increments"),
        ({"accelerometer": 0.01}, "increments seem to be taken as rates"),
        ({"accelerometer": 1.3}, "unit or scale is unknown"),
        ({"gyro": 180 / np.pi}, "in degrees: multiply by pi/180"),
        ({"gyro": 3600 * 180 / np.pi}, "in deg/h"),
        ({"gyro": np.pi / 180}, "multiply by 180/pi"),
        ({"gyro": 5.0}, "it moves, or its gyros are worse than their grade"),
        ({"accelerometer": np.diag([1.0, -1, -1])}, "z pointed up"),
        ({"accelerometer": np.eye(3)[[2, 0, 1]]}, "sensed along x: .* swapped"),
        ({"gyro": np.diag([1.0, 1, -1])}, "its sign seems to be wrong"),
        ({"gyro": np.eye(3)[[0, 2, 1]]}, "gyro axes seem to be swapped"),
    ],
)
def test_mistaken_units_and_axes_are_refused(change, message):
    log = mapped(log_of(grades.draw("navigation", 3)[0]), **change)
    with pytest.raises(InertialError, match=message):
        alignment.at_rest(log, POSITION_M, NAVIGATION)


def test_any_attitude_on_demand():
    upside_down = mapped(log_of(), *[np.diag([1.0, -1, -1])] * 2)
    with pytest.raises(InertialError, match="z pointed up"):
        alignment.at_rest(upside_down, POSITION_M, NAVIGATION)
    found = alignment.at_rest(upside_down, POSITION_M, NAVIGATION, tilted=True)
    assert abs(found.state.attitude_rad[0, 2]) == pytest.approx(np.pi - 0.08)


def test_motion_is_no_rest():
    log = log_of()
    moved = replace(log, velocity_m_s=log.velocity_m_s.copy())
    moved.velocity_m_s[2000:2300, 0] += 0.01
    with pytest.raises(InertialError, match="the IMU moves"):
        alignment.at_rest(moved, POSITION_M, NAVIGATION)
    turned = replace(log, rotation_rad=log.rotation_rad.copy())
    turned.rotation_rad[2000:2300, 2] += 1e-3
    with pytest.raises(InertialError, match="align in motion"):
        alignment.at_rest(turned, POSITION_M, NAVIGATION)
    with pytest.raises(InertialError, match="too few"):
        alignment.at_rest(log, POSITION_M, NAVIGATION, last_s=1.0)


def test_course_tells_the_heading():
    velocity = enu_matrix(*PLACE[:2]).T @ [3.0, 4.0, 0.5]
    found = alignment.from_course(7.0, POSITION_M, velocity)
    assert found.state.attitude_rad[0] == pytest.approx([np.arctan2(3, 4), 0.0997, 0.0], abs=1e-4)
    assert found.sigma.attitude_rad[2] == pytest.approx(np.hypot(0.01, 0.035))
    with pytest.raises(InertialError, match="faster than 1"):
        alignment.from_course(7.0, POSITION_M, 0.1 * velocity)


def test_a_given_state_is_taken_as_it_is():
    found = alignment.given(resting())
    assert found.state.time_s[0] == 0.0
    assert found.sigma.attitude_rad == (0.0, 0.0, 0.0)


def test_there_are_48_ways_to_name_axes():
    ways = alignment_checks.signed_axes()
    assert len({alignment_checks.named_axes(way) for way in ways}) == 48
    assert alignment_checks.named_axes(ways[0]) == "(x, y, z)"
    assert np.array_equal(ways[0], np.eye(3))


def test_bias_of_the_accelerometers_tilts():
    biased = ImuErrors(accelerometer=SensorErrors(bias=(0.01, 0.0, 0.0)))
    found = alignment.at_rest(log_of(biased), POSITION_M, NAVIGATION)
    assert found.state.attitude_rad[0, 1] - ATTITUDE[1] == pytest.approx(0.01 / 9.795, rel=0.02)
