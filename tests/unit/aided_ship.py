"""A ship with an INS, and satellites that are dragged: measurements, increments and the truth."""

from __future__ import annotations

from functools import cache

import numpy as np

from sdr_spoof.aiding import simulated as sim
from sdr_spoof.aiding.imu.errors import read
from sdr_spoof.aiding.imu.grades import draw
from sdr_spoof.aiding.imu.simulate import ideal_increments
from sdr_spoof.config import Config
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory

ORIGIN = np.array([34.0, 122.0, 20.0])
REFERENCE = GnssTime(1_362_571_218)
LOOKS = [(108 * k % 360, (15, 35, 70)[k % 3]) for k in range(10)]
LENGTH_S = 140.0
TIME = np.arange(0.0, LENGTH_S)
ATTACKED = ("C02", "C05", "C08")
LEVER_ARM = (3.0, -1.0, -12.0)


def way(time_s):
    """8 m/s to the east, to and fro, up and down."""
    return np.stack([8 * time_s, 60 * np.sin(time_s / 30), 0.5 * np.sin(time_s / 3)], axis=1)


SHIP = Trajectory(OnPlane(ORIGIN, way), lever_arm_m=LEVER_ARM)


@cache
def increments():
    ideal = ideal_increments(SHIP, LENGTH_S, 100.0, reference=REFERENCE)
    return read(ideal, draw("ship-a", 1)[0]).log


@cache
def measured(*attacks, seed=3):
    sky = sim.fixed(TIME, geodetic_to_ecef(ORIGIN), LOOKS)
    return sim.simulate(SHIP, sky, TIME, attacks=attacks, seed=seed, reference=REFERENCE).run()


def config(**more) -> Config:
    attitude = np.degrees(SHIP.attitude_rad(np.zeros(1)))[0].tolist()
    aided = {"grade": "ship-a", "attitude_deg": attitude} | more.pop("aided", {})
    return Config.model_validate({"aided": aided, "tight": {"settle_s": 30.0}} | more)


def error_m(track):
    return np.linalg.norm(track.position_m - SHIP.position_m(TIME), axis=1)
