"""An unmanned aircraft by chance: turns, climbs, changes of speed, and a hover if it is asked for.

The default is that of the study of pseudorange-rate consistency: from 108 degrees east, 34 degrees
north, 400 m, and due east for the first minute (the publication's aircraft does not move north at
25 to 50 s).
"""

from __future__ import annotations

import math
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from .manoeuvres import Leg, Way, curve, way
from .receiver_base import Drawn, Latitude, Longitude
from .trajectory import OnPlane, Trajectory

_GRAVITY_M_S2 = 9.80665
_BRAKE_M_S2 = 3.0
_SLOW_M_S = 5.0
"""Below it, the nose does not follow the way up and down."""


class Uav(Drawn):
    """An aircraft that banks into its turns."""

    kind: Literal["uav"] = Field("uav", description="kind of trajectory")
    latitude_deg: Latitude = Field(34.0, description="latitude at 0 s")
    longitude_deg: Longitude = Field(108.0, description="longitude at 0 s")
    height_m: float = Field(400.0, description="height at 0 s above the ellipsoid")
    speed_m_s: float = Field(40.0, gt=0, description="speed at 0 s; later from 0.6 to 1.1 of it")
    turn_m_s2: float = Field(3.7, gt=0, description="largest acceleration across in turns")
    straight_s: float = Field(60.0, ge=0, description="goes straight on until then")
    heading_deg: float = Field(90.0, description="heading at 0 s, from north to east")
    hover_s: tuple[float, float] | None = Field(
        None, description="stands still in the air from then to then, after going straight"
    )

    @model_validator(mode="after")
    def _can_stop(self) -> Self:
        if self.hover_s is not None:
            first, last = self.hover_s
            needs = self.speed_m_s / _BRAKE_M_S2 + 1.0
            if not needs <= first < last:
                raise ValueError(
                    f"hover_s: [{first:g}, {last:g}] must ascend and begin at {needs:.1f} s or "
                    "later, to leave time to slow down"
                )
        return self

    def trajectory(self, duration_s: float) -> Trajectory:
        """Level and straight at first, then by chance."""
        rng = np.random.default_rng([self.seed, 2])
        legs = self._opening()
        now_s = sum(leg.duration_s for leg in legs)
        flight = way(
            legs + self._legs(rng, duration_s - now_s),
            duration_s,
            speed_m_s=self.speed_m_s,
            heading_rad=math.radians(self.heading_deg),
            ease_s=2.0,
        )
        body = curve(flight.time_s, flight.east_m, flight.north_m, flight.height_m)
        looks = curve(flight.time_s, flight.heading_rad, _pitch(flight), _bank(flight))
        return Trajectory(OnPlane(self.origin, body), looks, self.lever_arm_m)

    def _opening(self) -> list[Leg]:
        if self.hover_s is None:
            return [Leg(self.straight_s)]
        first, last = self.hover_s
        slowing = self.speed_m_s / _BRAKE_M_S2
        return [
            Leg(first - 1.0 - slowing),
            Leg(slowing, speed_m_s=-self.speed_m_s),
            Leg(last - first + 2.0),
            Leg(slowing, speed_m_s=self.speed_m_s),
            Leg(max(2.0, self.straight_s - last - 1.0 - slowing)),
        ]

    def _legs(self, rng: np.random.Generator, duration_s: float) -> list[Leg]:
        legs: list[Leg] = []
        speed, height, spent_s = self.speed_m_s, 0.0, 0.0
        while spent_s < duration_s:
            kind = rng.choice(["turn", "speed", "climb"], p=[0.5, 0.2, 0.3])
            if kind == "turn":
                leg = self._turn(rng, speed)
            elif kind == "speed":
                change = self.speed_m_s * rng.uniform(0.6, 1.1) - speed
                leg = Leg(abs(change) / rng.uniform(0.5, 2.0), speed_m_s=change)
            else:
                climb = rng.uniform(-100.0, 100.0) - 0.5 * height
                leg = Leg(abs(climb) / rng.uniform(1.0, 3.0), climb_m=climb)
            legs += [leg, Leg(rng.uniform(5.0, 40.0))]
            speed, height = speed + leg.speed_m_s, height + leg.climb_m
            spent_s += leg.duration_s + legs[-1].duration_s
        return legs

    def _turn(self, rng: np.random.Generator, speed: float) -> Leg:
        angle = math.radians(rng.uniform(20.0, 180.0))
        across = rng.uniform(0.3, 1.0) * self.turn_m_s2
        return Leg(angle * speed / across, heading_rad=angle * rng.choice([-1.0, 1.0]))


def _bank(flight: Way) -> NDArray[np.float64]:
    """Roll at which a turn is felt straight downwards."""
    return np.arctan(flight.speed_m_s * flight.turn_rad_s / _GRAVITY_M_S2)


def _pitch(flight: Way) -> NDArray[np.float64]:
    return np.arctan(flight.climb_m_s / np.hypot(flight.speed_m_s, _SLOW_M_S))
