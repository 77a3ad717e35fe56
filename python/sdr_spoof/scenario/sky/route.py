"""A way through waypoints: straight legs, round turns of one acceleration, speeds at the points.

The way is made of pieces along which the speed grows or falls evenly; a turn is one at constant
speed. Its acceleration is smoothed by a triangle of 1 s, so that it has no steps: a turn is cut by
a T^2 / 24 with T = 0.7 s, 0.2 m at 1 g.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .trajectory import Curve, through

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

GRAVITY_M_S2 = 9.80665
_GRID_S = 0.02
_BOX = 25
"""Grid points of each of the two boxes that make up the triangle."""
_STRAIGHT_RAD = 1e-6


@dataclass(frozen=True)
class Point:
    """A waypoint: east, north, up in m, and the speed there."""

    place: tuple[float, float, float]
    speed_m_s: float


@dataclass(frozen=True)
class _Piece:
    """A straight line or an arc."""

    start: complex
    heading: complex
    """Direction at its start, east + j north."""
    length: float
    curvature: float
    """1/m, positive to the left."""
    heights: tuple[float, float]
    speeds: tuple[float, float]

    @property
    def duration_s(self) -> float:
        return 2 * self.length / sum(self.speeds)

    def places(self, into_s: NDArray[np.float64]) -> NDArray[np.float64]:
        first, last = self.speeds
        acceleration = (last - first) / self.duration_s
        way = (first + 0.5 * acceleration * into_s) * into_s
        turn = self.curvature * way
        chord = np.exp(0.5j * turn) * np.sinc(turn / math.tau)
        plane = self.start + self.heading * way * chord
        height = self.heights[0] + (self.heights[1] - self.heights[0]) * way / self.length
        return np.stack([plane.real, plane.imag, height], axis=-1)


def route(points: Sequence[Point], acceleration_m_s2: float, duration_s: float) -> Curve:
    """East, north, up against time; the first point is passed at 0 s.

    Before the first and after the last point it goes straight on at their speeds.

    Raises:
        ValueError: a turn does not fit between its neighbours, or the way has no speed.
    """
    pieces = _pieces(points, acceleration_m_s2)
    first = math.floor(-3.0 / _GRID_S)
    time_s = np.arange(first, math.ceil((duration_s + 3.0) / _GRID_S) + 1) * _GRID_S
    wide_s = np.arange(first - 2 * _BOX, first + time_s.size + 2 * _BOX) * _GRID_S
    box = np.ones(_BOX) / _BOX
    kernel = np.convolve(box, box)
    spare = (wide_s.size - kernel.size + 1 - time_s.size) // 2
    raw = _places(pieces, wide_s.astype(np.float64))
    smooth = np.stack([np.convolve(c, kernel, "valid") for c in raw.T], axis=-1)
    return through(time_s.astype(np.float64), smooth[spare : spare + time_s.size])


def _places(pieces: Sequence[_Piece], time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    ends = np.cumsum([p.duration_s for p in pieces])
    index = np.searchsorted(ends, np.clip(time_s, 0.0, ends[-1] - 1e-9), side="right")
    places = np.empty((time_s.size, 3))
    for k, piece in enumerate(pieces):
        mine = index == k
        into = time_s[mine] - (ends[k] - piece.duration_s)
        inside = np.clip(into, 0.0, piece.duration_s)
        places[mine] = piece.places(inside)
        beyond = into - inside
        if np.any(beyond):
            speed = np.where(beyond < 0, *piece.speeds)
            heading = piece.heading * np.exp(1j * piece.curvature * piece.length * (beyond > 0))
            way = heading * beyond * speed
            places[mine] += np.stack([way.real, way.imag, np.zeros_like(beyond)], axis=-1)
    return places


def _pieces(points: Sequence[Point], acceleration_m_s2: float) -> list[_Piece]:
    """Legs between the turns, and the turns."""
    plane = [complex(p.place[0], p.place[1]) for p in points]
    legs = [b - a for a, b in pairwise(plane)]
    if any(abs(leg) < 1e-3 for leg in legs):
        raise ValueError("waypoint: two in a row are at the same place")
    turns = [0.0, *(_turn(a, b) for a, b in pairwise(legs)), 0.0]
    radii = [p.speed_m_s**2 / acceleration_m_s2 for p in points]
    cut = [r * math.tan(abs(t) / 2) for r, t in zip(radii, turns, strict=True)]
    pieces = []
    for k, leg in enumerate(legs):
        length = abs(leg) - cut[k] - cut[k + 1]
        if length <= 0:
            raise ValueError(
                f"waypoint: the turns at numbers {k + 1} and {k + 2} need "
                f"{cut[k] + cut[k + 1]:.0f} m of the {abs(leg):.0f} m between them; move the "
                "points apart, slow down or raise turn_g"
            )
        heading = leg / abs(leg)
        ends = points[k], points[k + 1]
        speeds = (ends[0].speed_m_s, ends[1].speed_m_s)
        if not sum(speeds):
            raise ValueError(f"waypoint: speed_m_s is 0 at numbers {k + 1} and {k + 2}")
        heights = (ends[0].place[2], ends[1].place[2])
        pieces.append(_Piece(plane[k] + heading * cut[k], heading, length, 0.0, heights, speeds))
        if abs(turns[k + 1]) > _STRAIGHT_RAD and radii[k + 1] > 0:
            turn, radius, at = turns[k + 1], radii[k + 1], ends[1]
            start = plane[k + 1] - heading * cut[k + 1]
            curvature = math.copysign(1 / radius, turn)
            still = ((at.place[2],) * 2, (at.speed_m_s,) * 2)
            pieces.append(_Piece(start, heading, radius * abs(turn), curvature, *still))
    return pieces


def _turn(before: complex, after: complex) -> float:
    """Angle between two legs, positive to the left."""
    quotient = after / before
    return math.atan2(quotient.imag, quotient.real)
