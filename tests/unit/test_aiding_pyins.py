"""Against python-ins (N. Mayorov, MIT licence), an independent implementation.

Its simulator makes the increments from a motion, so that ours is checked from end to end, and both
navigate with them. Its gravity is linear in height (ours is of second order: 7e-6 m/s^2 apart at
400 m), so that this is at sea level.
"""

import os
import warnings

import numpy as np
import pytest

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.records import ImuLog, InertialStates
from sdr_spoof.nav.geodesy import enu_matrix, geodetic_to_ecef

# Numba would compile for seconds; the package has invalid escapes in its comments.
os.environ["NUMBA_DISABLE_JIT"] = "1"
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from pyins import sim
    from pyins import strapdown as reference

RATE_HZ = 100
SECONDS = 20
LLA = ["lat", "lon", "alt"]
VELOCITY = ["VN", "VE", "VD"]
ATTITUDE = ["heading", "pitch", "roll"]
BIASES = {"gyro": (1e-5, -2e-5, 3e-5), "accel": (0.01, 0.02, -0.01)}


def motion(seconds=SECONDS):
    """A ship that sways by 12 degrees and turns, as the package simulates it: truth, IMU."""
    time = np.arange(seconds * RATE_HZ + 1) / RATE_HZ
    sway = np.sin(0.7 * time + 0.3)
    velocity = np.stack([8 + sway, 3 * np.sin(0.2 * time), 0.5 * np.sin(0.8 * time)], axis=-1)
    rph = np.stack([12 * sway, 4 * np.sin(0.9 * time), 40 + 30 * np.sin(0.1 * time)], axis=-1)
    return sim.generate_imu(time, [34.0, 108.0, 0.0], rph, velocity, "increment")


def states(trajectory) -> InertialStates:
    places = trajectory[LLA].to_numpy()
    north_east_down = trajectory[VELOCITY].to_numpy()
    enu = north_east_down[:, [1, 0, 2]] * [1, 1, -1]
    velocity = [v @ enu_matrix(*p[:2]) for v, p in zip(enu, places, strict=True)]
    attitude = np.radians(trajectory[ATTITUDE].to_numpy())
    time = trajectory.index.to_numpy()
    position = geodetic_to_ecef(places)
    return InertialStates(None, time, position, np.array(velocity), attitude, np.zeros(len(time)))


def spoiled(imu):
    biased = imu.copy()
    for kind, values in BIASES.items():
        for axis, value in zip("xyz", values, strict=True):
            biased[f"{kind}_{axis}"] += value / RATE_HZ
    return biased


def ours(imu, start: InertialStates, mechanisation) -> InertialStates:
    rows = imu.iloc[1:]
    log = ImuLog(
        None,
        rows.index.to_numpy(),
        1 / RATE_HZ,
        rows[["gyro_x", "gyro_y", "gyro_z"]].to_numpy(),
        rows[["accel_x", "accel_y", "accel_z"]].to_numpy(),
    )
    return strapdown.navigate(log, start, every=RATE_HZ, mechanisation=mechanisation)


def largest(a: InertialStates, b: InertialStates) -> list[float]:
    """Difference of positions (m), velocities (m/s) and attitudes (rad)."""
    return [
        float(np.abs(a.position_m - b.position_m).max()),
        float(np.abs(a.velocity_m_s - b.velocity_m_s).max()),
        float(np.abs(a.attitude_rad - b.attitude_rad).max()),
    ]


@pytest.mark.parametrize("mechanisation", ["local", "earth-fixed"])
def test_its_simulated_motion_comes_back(mechanisation):
    trajectory, imu = motion()
    truth = states(trajectory.iloc[::RATE_HZ])
    found = ours(imu, strapdown.row(truth, 0), mechanisation)
    position, velocity, attitude = largest(found, truth)
    assert position < 1e-4
    assert velocity < 1e-6
    assert attitude < 1e-8


@pytest.mark.filterwarnings("ignore:The copy keyword")
def test_both_navigate_alike_with_biases():
    trajectory, imu = motion()
    imu = spoiled(imu)
    truth = states(trajectory.iloc[::RATE_HZ])
    increments = reference.compute_increments_from_imu(imu, "increment")
    theirs = states(reference.Integrator(trajectory.iloc[0]).integrate(increments).iloc[::RATE_HZ])
    found = ours(imu, strapdown.row(truth, 0), "local")
    drift = largest(theirs, truth)
    assert drift[0] > 2.0
    for ours_off, allowed in zip(largest(found, theirs), [1e-3, 1e-4, 1e-8], strict=True):
        assert ours_off < allowed
