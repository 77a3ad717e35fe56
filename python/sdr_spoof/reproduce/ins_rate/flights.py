"""Random flights of the study: straight ways of random length and banked turns between them.

The publication flies 100 random trajectories and says nothing of them but that they begin at rest
at 108 E, 34 N, 400 m, eastwards. How often a flight turns matters, since biases are fixed to the
body and turn with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.sky import earth
from sdr_spoof.scenario.sky.manoeuvres import Leg, curve, way
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory, rotations

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

ORIGIN = np.array([34.0, 108.0, 400.0])
DURATION_S = 1750.0
SPEED_M_S = 40.0
STRAIGHT_S = 60.0
"""Eastwards before the first turn: the publication's aircraft does not move north at 25 to 50 s."""
BETWEEN_S = 175.0
"""Mean length of a straight way. Chosen so that the false alarms come out as another simulation,
whose flights are not known, has them: that table is a check of its pattern, not a prediction."""
ACROSS_M_S2 = (1.0, 3.0)
TURN_DEG = (30.0, 150.0)
GRAVITY_M_S2 = 9.80665
SEED = 20_220_400


@dataclass(frozen=True)
class Sampled:
    """R flights at N times, in local axes (north, east, down)."""

    time_s: Floats
    """(N,)"""
    latitude_rad: Floats
    """(R, N)"""
    velocity_m_s: Floats
    """(R, N, 3)"""
    acceleration_m_s2: Floats
    """Rate of those components, (R, N, 3)."""
    attitude: Floats
    """Matrices from body to local axes, (R, N, 3, 3)."""

    @property
    def runs(self) -> int:
        """Number of flights."""
        return len(self.velocity_m_s)


def flight(
    number: int,
    between_s: float = BETWEEN_S,
    across_m_s2: tuple[float, float] = ACROSS_M_S2,
) -> Trajectory:
    """One random flight; ``between_s`` infinite: it never turns."""
    rng = np.random.default_rng([SEED, number])
    legs = [Leg(STRAIGHT_S)]
    while between_s < np.inf and sum(leg.duration_s for leg in legs) < DURATION_S:
        legs.append(Leg(2.0 + float(rng.exponential(between_s))))
        across = rng.uniform(*across_m_s2)
        angle = np.radians(rng.uniform(*TURN_DEG))
        turned = float(angle * rng.choice([-1.0, 1.0]))
        legs.append(Leg(float(angle * SPEED_M_S / across), heading_rad=turned))
    flown = way(
        legs, DURATION_S, speed_m_s=SPEED_M_S, heading_rad=float(np.radians(90.0)), ease_s=2.0
    )
    bank = np.arctan(flown.speed_m_s * flown.turn_rad_s / GRAVITY_M_S2)
    body = curve(flown.time_s, flown.east_m, flown.north_m, flown.height_m)
    looks = curve(flown.time_s, flown.heading_rad, 0.0 * bank, bank)
    return Trajectory(OnPlane(ORIGIN, body), looks)


def sampled(flights: Sequence[Trajectory], step_s: float = 0.5) -> Sampled:
    """The flights at every ``step_s``."""
    time_s = np.asarray(np.arange(round(DURATION_S / step_s) + 1) * step_s, np.float64)
    parts = [_one(flight, time_s, step_s) for flight in flights]
    latitude, velocity, acceleration, attitude = (np.stack(p) for p in zip(*parts, strict=True))
    return Sampled(time_s, latitude, velocity, acceleration, attitude)


def _one(flight: Trajectory, time_s: Floats, step_s: float) -> tuple[Floats, ...]:
    body = flight.body
    assert isinstance(body, OnPlane)
    places = earth.from_plane(body.origin, body.enu_m(time_s))
    enu = body.velocity_enu_m_s(time_s)
    velocity = np.stack([enu[:, 1], enu[:, 0], -enu[:, 2]], axis=-1)
    acceleration = np.gradient(velocity, step_s, axis=0)
    return np.radians(places[:, 0]), velocity, acceleration, rotations(flight.attitude_rad(time_s))
