"""The same flights through the strapdown computer: increments, IMU errors, free navigation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.imu import grades
from sdr_spoof.aiding.imu.errors import ImuErrors, SensorErrors
from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.scenario.sky import earth
from sdr_spoof.scenario.sky.trajectory import Trajectory

from . import published
from .flights import ORIGIN, flight
from .simulated import BIAS_SEED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import ImuLog, InertialStates
    from sdr_spoof.aiding.strapdown import RunStates

    Floats = NDArray[np.float64]

RATE_HZ = 100
KINDS = ("perfect", "n1", "n2")


@dataclass(frozen=True)
class Flown:
    """Errors of INS on one flight at M whole seconds, east, north, up, INS minus truth."""

    position_m: Floats
    """Of ``KINDS``, (3, M, 3)."""
    velocity_m_s: Floats


@cache
def recorded(number: int) -> tuple[Trajectory, ImuLog]:
    """A flight, and what a perfect IMU senses on it."""
    way = flight(number)
    return way, ideal_increments(way, published.DURATION_S, RATE_HZ)


def fly(number: int, seed: int) -> Flown:
    """Flight ``number`` with the perfect IMU, and N1 and N2 with its own biases."""
    way = flight(number)
    log = ideal_increments(way, published.DURATION_S, RATE_HZ)
    errors = [ImuErrors(), *(imu(name, number, seed) for name in published.GRADES)]
    start = true_states(way, np.zeros(1))
    states = strapdown.navigate_runs(log, start, errors, every=RATE_HZ)
    return flown(states, true_states(way, states.time_s))


def imu(name: str, number: int, seed: int = BIAS_SEED) -> ImuErrors:
    """The IMU of a grade on a flight."""
    return grades.one_run(grades.named(name), seed, number)


def flown(states: RunStates, true: InertialStates) -> Flown:
    """What states are off by."""
    axes = earth.enu_axes(true.position_m)
    away = np.einsum("mij,rmj->rmi", axes, states.position_m - true.position_m)
    speed = np.einsum("mij,rmj->rmi", axes, states.velocity_m_s - true.velocity_m_s)
    return Flown(away, speed)


def standing() -> Flown:
    """An IMU at rest, nose to the north: a gyro bias about east, an accelerometer bias east."""
    origin = geodetic_to_ecef(ORIGIN)
    place = Trajectory(
        lambda time_s: np.broadcast_to(origin, (np.size(time_s), 3)),
        lambda time_s: np.zeros((np.size(time_s), 3)),
    )
    log = ideal_increments(place, published.DURATION_S, RATE_HZ)
    gyro = SensorErrors(bias=(0.0, 0.1 * grades.DEG_HOUR, 0.0))
    force = SensorErrors(bias=(0.0, 10 * grades.MICRO_G, 0.0))
    errors = [ImuErrors(), ImuErrors(gyro=gyro), ImuErrors(accelerometer=force)]
    start = true_states(place, np.zeros(1))
    states = strapdown.navigate_runs(log, start, errors, every=RATE_HZ)
    return flown(states, true_states(place, states.time_s))
