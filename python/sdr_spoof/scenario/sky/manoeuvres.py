"""Ways made of manoeuvres: times of even change of speed, heading and height, with soft joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicSpline

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .trajectory import Curve

_SPARE_S = 3.0
"""Before 0 s and after the end."""


@dataclass(frozen=True)
class Leg:
    """A manoeuvre: what changes evenly while it lasts."""

    duration_s: float
    speed_m_s: float = 0.0
    """Change of speed."""
    heading_rad: float = 0.0
    """Change of heading, positive to the right."""
    climb_m: float = 0.0


@dataclass(frozen=True)
class Way:
    """A way on a plane at the times of a grid, which reaches a little beyond its ends."""

    time_s: NDArray[np.float64]
    """(N,)"""
    speed_m_s: NDArray[np.float64]
    heading_rad: NDArray[np.float64]
    """From north to east, not wrapped."""
    turn_rad_s: NDArray[np.float64]
    height_m: NDArray[np.float64]
    """Above that at 0 s."""
    climb_m_s: NDArray[np.float64]
    east_m: NDArray[np.float64]
    """From the place at 0 s."""
    north_m: NDArray[np.float64]
    length_m: NDArray[np.float64]
    """Way gone since 0 s."""


def way(
    legs: Sequence[Leg],
    duration_s: float,
    *,
    speed_m_s: float,
    heading_rad: float,
    ease_s: float = 1.0,
    grid_s: float = 0.1,
) -> Way:
    """Drives the legs one after another.

    Args:
        legs: Manoeuvres from 0 s on; before and after them nothing changes.
        duration_s: Length.
        speed_m_s: Speed at 0 s.
        heading_rad: Heading at 0 s.
        ease_s: Rates come and go within this time: speeds and headings are smoothed by a triangle
            of this width.
        grid_s: Spacing of the times of the result.
    """
    time_s = np.arange(-_SPARE_S, duration_s + _SPARE_S + grid_s, grid_s)
    edges = np.concatenate([[0.0], np.cumsum([leg.duration_s for leg in legs])])

    def course(start: float, changes: list[float]) -> NDArray[np.float64]:
        values = start + np.concatenate([[0.0], np.cumsum(changes)])
        return _eased(edges, values, time_s, round(ease_s / 2 / grid_s))

    speed = course(speed_m_s, [leg.speed_m_s for leg in legs])
    heading = course(heading_rad, [leg.heading_rad for leg in legs])
    height = course(0.0, [leg.climb_m for leg in legs])
    return Way(
        time_s=time_s,
        speed_m_s=speed,
        heading_rad=heading,
        turn_rad_s=np.gradient(heading, grid_s),
        height_m=height,
        climb_m_s=np.gradient(height, grid_s),
        east_m=_integral(time_s, speed * np.sin(heading)),
        north_m=_integral(time_s, speed * np.cos(heading)),
        length_m=_integral(time_s, speed),
    )


def curve(time_s: NDArray[np.float64], *columns: NDArray[np.float64]) -> Curve:
    """A smooth curve through three columns; as at its ends beyond them."""
    spline = CubicSpline(time_s, np.stack(columns, axis=-1), bc_type="natural")
    return lambda at_s: np.asarray(spline(np.clip(at_s, time_s[0], time_s[-1])))


def _eased(
    edges_s: NDArray[np.float64],
    values: NDArray[np.float64],
    time_s: NDArray[np.float64],
    half: int,
) -> NDArray[np.float64]:
    """A broken line, smoothed by a triangle of this many steps to either side."""
    step_s = time_s[1] - time_s[0]
    box = np.ones(max(1, half))
    kernel = np.convolve(box, box) / box.size**2
    spare = (kernel.size - 1) // 2
    wide_s = time_s[0] + step_s * np.arange(-spare, time_s.size + spare)
    return np.convolve(np.interp(wide_s, edges_s, values), kernel, "valid")


def _integral(time_s: NDArray[np.float64], rate: NDArray[np.float64]) -> NDArray[np.float64]:
    whole = CubicSpline(time_s, rate).antiderivative()
    return np.asarray(whole(time_s) - whole(0.0))
