"""Flights with an INS that drifts by its linear error model, and measurements of them."""

import numpy as np

from sdr_spoof.aiding.detectors import budget, growth
from sdr_spoof.aiding.detectors.changes import States
from sdr_spoof.aiding.rate_config import RateConfig
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.aiding.simulated import ClockWalk, ReceiverNoise, fixed, simulate
from sdr_spoof.config import Config
from sdr_spoof.scenario.sky import earth
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory, rotations

ORIGIN = np.array([34.0, 108.0, 400.0])
DIRECTIONS = ((20, 40), (75, 25), (130, 55), (165, 45), (200, 50), (235, 30), (290, 65), (320, 20))
DEG_H, MICRO_G = np.radians(1) / 3600, 9.80665e-6


def circle(speed_m_s=40.0, across_m_s2=3.0):
    """Round a circle from its eastern end, to the left."""
    radius = speed_m_s**2 / across_m_s2

    def enu(time_s):
        angle = speed_m_s / radius * time_s
        return radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)

    return Trajectory(OnPlane(ORIGIN, enu))


def straight(speed_m_s=40.0):
    """Northwards."""
    return Trajectory(OnPlane(ORIGIN, lambda t: np.stack([0 * t, speed_m_s * t, 0 * t], axis=-1)))


def true_states(trajectory, time_s):
    """The INS without errors."""
    return InertialStates(
        None,
        time_s,
        trajectory.position_m(time_s),
        trajectory.velocity_m_s(time_s),
        trajectory.attitude_rad(time_s),
        time_s - time_s[0],
    )


def to_earth(position_m):
    """Matrices from north, east, down."""
    axes = earth.enu_axes(position_m)
    return np.stack([axes[:, 1], axes[:, 0], -axes[:, 2]], axis=-1)


def drifting(trajectory, time_s, gyro=(0.0, 0.0, 0.0), accelerometer=(0.0, 0.0, 0.0)):
    """An INS with constant biases in degrees/h and millionths of g, aligned perfectly."""
    true = true_states(trajectory, time_s)
    matrices = to_earth(true.position_m) @ rotations(true.attitude_rad)
    steps = growth.steps(
        States(true.position_m, true.velocity_m_s, matrices, true.aligned_s),
        time_s,
        budget.of(RateConfig()),
    )
    error = np.zeros((time_s.size, growth.STATES))
    error[:, growth.GYRO] = np.array(gyro) * DEG_H
    error[:, growth.ACCELEROMETER] = np.array(accelerometer) * MICRO_G
    for k in range(1, time_s.size):
        error[k] = steps.transition[k] @ error[k - 1]
    return InertialStates(
        None,
        time_s,
        true.position_m + error[:, growth.POSITION],
        true.velocity_m_s + error[:, growth.VELOCITY],
        true.attitude_rad,
        true.aligned_s,
    )


def measured(trajectory, time_s, attacks=(), carrier_m=0.005, seed=1, **noise):
    """What a receiver measures of eight satellites."""
    sky = fixed(time_s, trajectory.position_m(time_s[:1])[0], DIRECTIONS)
    drawn = ReceiverNoise(carrier_m=carrier_m, **noise)
    return simulate(trajectory, sky, time_s, drawn, ClockWalk(), attacks, seed).run()


def config(**rate):
    """Configuration with these settings of ``[rate]``."""
    return Config(rate=RateConfig(**rate))
