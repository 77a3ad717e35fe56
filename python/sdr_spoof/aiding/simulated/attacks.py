"""Attacks as they show in measurements: ranges, rates and changes of an antenna that is elsewhere.

An attack displaces the antenna that the attacked signals tell of, or adds to their ranges alone;
rates are the exact derivatives and changes the exact differences of what is added. It is on the
air from ``start_s`` until before ``end_s``; with its end everything is true again at once. East,
north and up are those of the antenna's place at the first epoch.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.sky import earth

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.scenario.sky.trajectory import Trajectory

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Scene:
    """What an attack finds: epochs and the true antenna."""

    time_s: NDArray[np.float64]
    """(E,)"""
    position_m: NDArray[np.float64]
    """(E, 3)"""
    velocity_m_s: NDArray[np.float64]
    """(E, 3)"""


Moved = Callable[[Scene, float], "tuple[NDArray[np.float64], NDArray[np.float64]]"]
"""From a scene and the start to displacement and velocity of the false antenna against the true
one, Earth-fixed (E, 3) each."""


@dataclass(frozen=True)
class Attack:
    """One attack; the functions of this module make those that have names."""

    name: str
    start_s: float
    end_s: float = math.inf
    satellites: tuple[str, ...] | None = None
    """RINEX names of those attacked; None: all."""
    moved: Moved | None = None
    """Displacement of the antenna; None: there is none."""
    pull: Vector = (0.0, 0.0, 0.0)
    """Added to all ranges: m, m/s, m/s^2."""
    code_only: bool = False
    """Whether rates and changes stay true."""
    rise_db: float = 0.0
    """Of C/N0 while on the air."""
    slips: bool = False
    """Whether carrier phase slips where the attack begins and ends: changes are NaN there."""

    def active(self, time_s: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Epochs (E,) at which it is on the air."""
        return np.asarray((time_s >= self.start_s) & (time_s < self.end_s))

    def columns(self, names: Sequence[str]) -> NDArray[np.bool_]:
        """Which satellites it takes (S,).

        Raises:
            ValueError: it names one that is not there.
        """
        if self.satellites is None:
            return np.ones(len(names), np.bool_)
        strange = [s for s in self.satellites if s not in names]
        if strange:
            raise ValueError(
                f"{self.name}: there is no satellite {strange[0]}; name one of those "
                f"simulated: {', '.join(names)}"
            )
        return np.array([n in self.satellites for n in names])

    def pulled(self, time_s: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """What it adds to ranges and to rates by itself, (E,) each."""
        return _quadratic(self.pull, time_s - self.start_s)


def position_step(
    enu_m: Vector, start_s: float, end_s: float = math.inf, **other: object
) -> Attack:
    """The antenna is elsewhere: east, north, up in m."""
    return _displaced("position step", (enu_m, _NONE, _NONE), start_s, end_s, other)


def velocity_drag(
    enu_m_s: Vector, start_s: float, end_s: float = math.inf, **other: object
) -> Attack:
    """The antenna moves away at a constant velocity: east, north, up in m/s."""
    return _displaced("velocity drag", (_NONE, enu_m_s, _NONE), start_s, end_s, other)


def accelerated_drag(
    enu_m_s2: Vector, start_s: float, end_s: float = math.inf, **other: object
) -> Attack:
    """The antenna moves away at a constant acceleration: east, north, up in m/s^2."""
    return _displaced("accelerated drag", (_NONE, _NONE, enu_m_s2), start_s, end_s, other)


def hover(start_s: float, end_s: float = math.inf, **other: object) -> Attack:
    """The antenna stands still where it was at the start."""

    def moved(scene: Scene, start_s: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        where = np.array([np.interp(start_s, scene.time_s, x) for x in scene.position_m.T])
        return where - scene.position_m, -scene.velocity_m_s

    return Attack("hover", start_s, end_s, moved=moved, **other)  # type: ignore[arg-type]


def false_trajectory(
    trajectory: Trajectory, start_s: float, end_s: float = math.inf, **other: object
) -> Attack:
    """The antenna is on another trajectory, of the same times."""

    def moved(scene: Scene, start_s: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        del start_s
        where = trajectory.position_m(scene.time_s) - scene.position_m
        return where, trajectory.velocity_m_s(scene.time_s) - scene.velocity_m_s

    return Attack("false trajectory", start_s, end_s, moved=moved, **other)  # type: ignore[arg-type]


def clock_step(step_m: float, start_s: float, end_s: float = math.inf, **other: object) -> Attack:
    """All ranges attacked jump alike."""
    return range_pull((step_m, 0.0, 0.0), start_s, end_s, name="clock step", **other)


def clock_drag(rate_m_s: float, start_s: float, end_s: float = math.inf, **other: object) -> Attack:
    """All ranges attacked grow alike."""
    return range_pull((0.0, rate_m_s, 0.0), start_s, end_s, name="clock drag", **other)


def range_pull(
    pull: Vector,
    start_s: float,
    end_s: float = math.inf,
    name: str = "range pull",
    **other: object,
) -> Attack:
    """Ranges attacked grow by a step in m, m/s and m/s^2, whatever the geometry."""
    return Attack(name, start_s, end_s, pull=pull, **other)  # type: ignore[arg-type]


_NONE = (0.0, 0.0, 0.0)


def _displaced(
    name: str,
    terms: tuple[Vector, Vector, Vector],
    start_s: float,
    end_s: float,
    other: dict[str, object],
) -> Attack:
    """Displacement by east, north, up of m, m/s and m/s^2, along the axes of the first epoch."""

    def moved(scene: Scene, start_s: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        since_s = scene.time_s - start_s
        axes = earth.enu_axes(scene.position_m[:1])[0]
        away, speed = _quadratic(np.array(terms), since_s[:, None])
        return away @ axes, speed @ axes

    return Attack(name, start_s, end_s, moved=moved, **other)  # type: ignore[arg-type]


def _quadratic(
    terms: Sequence[object] | NDArray[np.float64], since_s: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A step, a rate and an acceleration at times since the start, and their rate."""
    step, rate, acceleration = np.asarray(terms, np.float64)
    return step + rate * since_s + 0.5 * acceleration * since_s**2, rate + acceleration * since_s
