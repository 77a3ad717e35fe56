"""A road drive by chance: starts, stops, turns, hills."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from .manoeuvres import Leg, curve, way
from .receiver_base import Drawn
from .trajectory import OnPlane, Trajectory

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ROLL_RAD_S2_M = math.radians(5.0) / 9.80665
"""Lean of a car outwards in a turn: 5 degrees at 1 g, a common roll gradient of passenger cars."""
_SPEEDS_M_S = (6.0, 22.0)
_HILLS_M = (400.0, 3000.0)
"""Lengths of hills and dales."""


class Vehicle(Drawn):
    """A car on roads."""

    kind: Literal["vehicle"] = Field("vehicle", description="kind of trajectory")
    turn_m_s2: float = Field(3.0, gt=0, description="largest acceleration across in turns")
    stand_s: float = Field(10.0, ge=0, description="stands so long at first")
    slope: float = Field(0.02, ge=0, lt=0.3, description="rms slope of the road")

    def trajectory(self, duration_s: float) -> Trajectory:
        """Stands, then drives."""
        rng = np.random.default_rng([self.seed, 1])
        legs = _legs(rng, duration_s, self.stand_s, self.turn_m_s2)
        drive = way(legs, duration_s, speed_m_s=0.0, heading_rad=rng.uniform(0, math.tau))
        height, slope = _hills(rng, drive.length_m, self.slope)
        body = curve(drive.time_s, drive.east_m, drive.north_m, height)
        lean = -_ROLL_RAD_S2_M * drive.speed_m_s * drive.turn_rad_s
        looks = curve(drive.time_s, drive.heading_rad, np.arctan(slope), lean)
        return Trajectory(OnPlane(self.origin, body), looks, self.lever_arm_m)


def _legs(
    rng: np.random.Generator, duration_s: float, stand_s: float, turn_m_s2: float
) -> list[Leg]:
    legs, now_s, speed = [Leg(stand_s)], stand_s, 0.0
    while now_s < duration_s:
        if speed and rng.random() < 0.55:
            more = [_turn(rng, speed, turn_m_s2)]
        else:
            stops = speed > 0 and rng.random() < 0.5
            more = [_change(rng, speed, 0.0 if stops else rng.uniform(*_SPEEDS_M_S))]
        speed += more[0].speed_m_s
        more.append(Leg(rng.uniform(4.0, 25.0)))
        legs += more
        now_s += sum(leg.duration_s for leg in more)
    return legs


def _turn(rng: np.random.Generator, speed: float, turn_m_s2: float) -> Leg:
    angle = math.radians(rng.uniform(30.0, 100.0))
    across = rng.uniform(0.4, 1.0) * turn_m_s2
    return Leg(angle * speed / across, heading_rad=angle * rng.choice([-1.0, 1.0]))


def _change(rng: np.random.Generator, speed: float, target: float) -> Leg:
    limits = (0.8, 2.5) if target > speed else (1.0, 3.0)
    return Leg(abs(target - speed) / rng.uniform(*limits), speed_m_s=target - speed)


def _hills(
    rng: np.random.Generator, length_m: NDArray[np.float64], slope: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Height above that at 0 s, and slope, along a road."""
    number = math.tau / rng.uniform(*_HILLS_M, 6)
    phase = number * length_m[:, None] + rng.uniform(0, math.tau, 6)
    size = slope * math.sqrt(2 / 6) / number
    height = (size * np.sin(phase)).sum(axis=1)
    start = np.interp(0.0, length_m, height)
    return height - start, (size * number * np.cos(phase)).sum(axis=1)
