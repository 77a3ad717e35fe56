"""A short voyage of a ship for the tightly coupled filter: increments, truth, measurements."""

from __future__ import annotations

from functools import cache

import numpy as np

from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.aiding.simulated import fixed, simulate
from sdr_spoof.aiding.tight import Start, TightConfig
from sdr_spoof.scenario.sky.ship import Ship

SKY = [(14, 49), (30, 70), (81, 16), (112, 34), (133, 19), (155, 52), (239, 70), (303, 40)]
SECONDS = 200.0
CONFIG = TightConfig(clock_drift_m2_s3=0.0004)


@cache
def made():
    """Perfect increments, and the truth at the epochs."""
    ship = Ship(kind="ship", seed=4, latitude_deg=30.5, longitude_deg=122.3)
    trajectory = ship.trajectory(SECONDS)
    time_s = np.arange(0.0, SECONDS, 1.0)
    truth = true_states(trajectory, time_s)
    return ideal_increments(trajectory, SECONDS, 100.0), truth


def measured(voyage, *attacks, seed=3, noise=None):
    truth = voyage[1]
    sky = fixed(truth.time_s, truth.position_m[0], SKY)
    moving = (truth.position_m, truth.velocity_m_s)
    return simulate(moving, sky, truth.time_s, noise, attacks=attacks, seed=seed).run()


def start(voyage):
    truth = voyage[1]
    return Start(
        0.0,
        tuple(truth.position_m[0]),
        tuple(truth.velocity_m_s[0]),
        tuple(truth.attitude_rad[0]),
    )


def distance(solution, voyage):
    return np.linalg.norm(solution.error_ned_m(voyage[1].position_m)[:, :2], axis=1)
