"""From orbits and an antenna's motion to what its receiver would measure.

The signal received at the time t left the satellite at t - tau, where c tau is the distance between
the antenna at t and the satellite at t - tau in one inertial frame: the satellite's Earth-fixed
place is turned by the Earth's rotation during tau (Sagnac). Ionosphere and troposphere add to the
way, but do not move the place of transmission, which changes by 4 km/s times 100 ns at most.

A pseudorange is c times the time that the receiver's clock shows, less that of the satellite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicSpline

from sdr_spoof import _core
from sdr_spoof.nav.geodesy import azimuth_elevation
from sdr_spoof.scenario.base import SPEED_OF_LIGHT

if TYPE_CHECKING:
    from numpy.typing import NDArray

ITERATIONS = 4
"""Of the light-time equation, from 75 ms: each leaves v/c = 1e-5 of the last one's error."""

Orbit = Callable[["NDArray[np.float64]"], "tuple[NDArray[np.float64], NDArray[np.float64]]"]
"""From times of system time since the start (N,) to Earth-fixed positions (N, 3) and clocks (N,),
relativity included, group delays not."""


@dataclass(frozen=True)
class Geometry:
    """Way of a signal, at N times."""

    distance_m: NDArray[np.float64]
    """Between the antenna at reception and the satellite at transmission, c tau."""
    clock_s: NDArray[np.float64]
    """The satellite's, at transmission."""
    azimuth_rad: NDArray[np.float64]
    elevation_rad: NDArray[np.float64]


def geometry(
    orbit: Orbit,
    earth_rate: float,
    time_s: NDArray[np.float64],
    antenna_m: NDArray[np.float64],
) -> Geometry:
    """Solve the light-time equation.

    Args:
        orbit: positions and clocks of the satellite.
        earth_rate: rotation of the Earth in rad/s, that of the satellite's system.
        time_s: times of reception, system time since the start, (N,).
        antenna_m: Earth-fixed positions of the antenna then, (N, 3).
    """
    place, clock_s, travel_s = _light_time(orbit, earth_rate, time_s, antenna_m)
    azimuth, elevation = np.radians(azimuth_elevation(antenna_m, place)).T
    return Geometry(travel_s * SPEED_OF_LIGHT, clock_s, azimuth, elevation)


def seen(
    orbit: Orbit,
    earth_rate: float,
    time_s: NDArray[np.float64],
    antenna_m: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Where the satellite was at transmission, in the Earth-fixed axes at reception, (N, 3).

    Arguments as of :func:`geometry`.
    """
    return _light_time(orbit, earth_rate, time_s, antenna_m)[0]


def _light_time(
    orbit: Orbit,
    earth_rate: float,
    time_s: NDArray[np.float64],
    antenna_m: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Place (N, 3), satellite's clock and travel time in s (N,)."""
    travel_s = np.full(time_s.shape, 0.075)
    for _ in range(ITERATIONS):
        position, clock_s = orbit(time_s - travel_s)
        place = _turned(position, earth_rate * travel_s)
        travel_s = np.linalg.norm(place - antenna_m, axis=1) / SPEED_OF_LIGHT
    return place, clock_s, travel_s


def spline(time_s: NDArray[np.float64], range_m: NDArray[np.float64]) -> _core.Spline:
    """A range as the core takes it: the rates are those of a cubic spline through the values.

    Args:
        time_s: evenly spaced times of the receiver's clock since the start, (N,).
        range_m: pseudoranges there, (N,).
    """
    middle = range_m[len(range_m) // 2]
    rate = CubicSpline(time_s, range_m - middle).derivative()(time_s)
    return _core.Spline(time_s, np.ascontiguousarray(range_m), np.ascontiguousarray(rate))


def _turned(position: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places in a frame that has turned by an angle about the Earth's axis since."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = position.T
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=-1)
