"""A ship by chance: long legs, slow turns, and the sea under it."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .manoeuvres import Leg, curve, way
from .receiver_base import Drawn
from .trajectory import OnPlane, Trajectory
from .waves import SEAS, Hull, Sea

_TURN_DEG_S = (0.4, 1.0)
_TURN_DEG = (20.0, 90.0)
_EASE_S = 8.0
_GRID_S = 0.2
"""Ships and what is left of waves under them are slow."""
_SLENDER = 5.0


class Ship(Drawn):
    """A ship that heaves, rolls and pitches."""

    kind: Literal["ship"] = Field("ship", description="kind of trajectory")
    speed_m_s: float = Field(8.0, ge=0, description="speed through all")
    heading_deg: float | None = Field(None, description="heading at 0 s (default: by the seed)")
    leg_s: tuple[float, float] = Field((60.0, 240.0), description="shortest and longest leg")
    sea_state: int = Field(4, ge=0, lt=len(SEAS), description="of WMO code table 3700; 0: calm")
    waves_from_deg: float | None = Field(None, description="direction (default: by the seed)")
    length_m: float = Field(60.0, gt=0, description="length; the beam is a fifth of it")
    roll_period_s: float = Field(12.0, gt=0, description="natural period of rolling")
    pitch_period_s: float = Field(7.0, gt=0, description="natural period of pitching and heaving")

    def trajectory(self, duration_s: float) -> Trajectory:
        """Course and waves."""
        rng = np.random.default_rng([self.seed, 3])
        heading = rng.uniform(0, math.tau)
        waves = rng.uniform(0, math.tau)
        if self.heading_deg is not None:
            heading = math.radians(self.heading_deg)
        if self.waves_from_deg is not None:
            waves = math.radians(self.waves_from_deg) + math.pi
        sea = Sea.drawn(self.sea_state, waves, rng)
        course = way(
            self._legs(rng, duration_s),
            duration_s,
            speed_m_s=self.speed_m_s,
            heading_rad=heading,
            ease_s=_EASE_S,
            grid_s=_GRID_S,
        )
        hull = Hull(
            length_m=self.length_m,
            beam_m=self.length_m / _SLENDER,
            heave_s=self.pitch_period_s,
            roll_s=self.roll_period_s,
            pitch_s=self.pitch_period_s,
        )
        heave, pitch, roll = sea.moves(course, hull)
        body = curve(course.time_s, course.east_m, course.north_m, heave)
        looks = curve(course.time_s, course.heading_rad, pitch, roll)
        return Trajectory(OnPlane(self.origin, body), looks, self.lever_arm_m)

    def _legs(self, rng: np.random.Generator, duration_s: float) -> list[Leg]:
        legs: list[Leg] = []
        spent_s = 0.0
        while spent_s < duration_s:
            angle = rng.uniform(*_TURN_DEG)
            turn = Leg(
                angle / rng.uniform(*_TURN_DEG_S),
                heading_rad=math.radians(angle) * rng.choice([-1.0, 1.0]),
            )
            legs += [Leg(rng.uniform(*self.leg_s)), turn]
            spent_s += legs[-2].duration_s + turn.duration_s
        return legs
