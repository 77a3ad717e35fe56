"""Where the satellites are, seen from the antenna, at the epochs of a simulation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.geodesy import azimuth_elevation, ecef_to_geodetic, enu_matrix
from sdr_spoof.scenario.sky import orbits
from sdr_spoof.scenario.sky.ranges import seen
from sdr_spoof.signals import satellite_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from sdr_spoof.nav.ephemeris import Ephemeris
    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.scenario.sky import SkyTable

DISTANCE_M = 2.2e7
"""Of satellites that are given by their direction alone."""
_DELTA_S = 0.05
"""Half the interval of a central difference: off by the third derivative (2e-4 m/s^3) times
4e-4 s^2, and by 4e-8 m/s of rounding."""


@dataclass(frozen=True)
class Constellation:
    """S satellites at E epochs; Earth-fixed, where they were at transmission, in the axes at
    reception."""

    names: tuple[str, ...]
    """RINEX names."""
    position_m: NDArray[np.float64]
    """(E, S, 3)"""
    velocity_m_s: NDArray[np.float64]
    """Rate of ``position_m`` by the time of reception, (E, S, 3)."""
    cn0_dbhz: NDArray[np.float64]
    """(E, S); NaN where the satellite is not received."""


def fixed(
    time_s: ArrayLike,
    place_m: ArrayLike,
    azimuth_elevation_deg: ArrayLike,
    names: Sequence[str] = (),
    cn0_dbhz: float = 45.0,
    distance_m: float = DISTANCE_M,
) -> Constellation:
    """Satellites that stand still over the Earth.

    Args:
        time_s: epochs (E,).
        place_m: Earth-fixed place (3,) that they are seen from.
        azimuth_elevation_deg: their directions there, (S, 2).
        names: RINEX names; C01, C02 ... if none are given.
        cn0_dbhz: of all.
        distance_m: of all.
    """
    azimuth, elevation = np.radians(np.asarray(azimuth_elevation_deg, np.float64)).T
    level = np.cos(elevation)
    up = np.stack([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)], axis=-1)
    place = np.asarray(place_m, np.float64)
    latitude, longitude, _ = ecef_to_geodetic(place)
    where = place + distance_m * up @ enu_matrix(latitude, longitude)
    epochs = np.asarray(time_s).size
    position = np.broadcast_to(where, (epochs, *where.shape))
    return Constellation(
        tuple(names) or tuple(satellite_name("C", k + 1) for k in range(len(where))),
        position,
        np.zeros_like(position),
        np.full(position.shape[:2], cn0_dbhz),
    )


def of_sky(
    table: SkyTable,
    time_s: NDArray[np.float64],
    place_m: ArrayLike,
    velocity_m_s: ArrayLike = (0.0, 0.0, 0.0),
) -> Constellation:
    """Satellites of a scenario's ``[sky]`` on their orbits, above its mask at any of the epochs.

    Args:
        table: the sky; its ``start`` is the reference of the times.
        time_s: epochs (E,).
        place_m: Earth-fixed places of the antenna, (E, 3) or (3,).
        velocity_m_s: its velocities, likewise; they matter by v/c times 4 km/s.

    Raises:
        ValueError: there are no orbits for the time.
    """
    start = table.start_time
    shape = (time_s.size, 3)
    places, speeds = (np.broadcast_to(np.asarray(x, float), shape) for x in (place_m, velocity_m_s))
    known = orbits.chosen(orbits.navigation(table), table, start, float(time_s[-1]))
    names, columns = [], []
    for e in sorted(known, key=lambda e: (e.system, e.prn)):
        override = table.override(e.system, e.prn)
        column = _column(e, start, time_s, places, speeds)
        cn0 = _cn0_dbhz(table, override.cn0_dbhz, column[2])
        if override.on_air and np.isfinite(cn0).any():
            names.append(satellite_name(e.system, e.prn))
            columns.append((column[0], column[1], cn0))
    if not names:
        raise ValueError("no satellite of the sky is above the mask at any epoch")
    position, velocity, cn0 = (np.stack(part, axis=1) for part in zip(*columns, strict=True))
    return Constellation(tuple(names), position, velocity, cn0)


def _column(
    ephemeris: Ephemeris,
    start: GnssTime,
    time_s: NDArray[np.float64],
    places: NDArray[np.float64],
    speeds: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Position, velocity (E, 3) and elevation in degrees (E,) of one satellite."""
    orbit, rate = orbits.orbit(ephemeris, start), orbits.earth_rate(ephemeris)
    before, here, after = (
        seen(orbit, rate, time_s + d, places + d * speeds) for d in (-_DELTA_S, 0.0, _DELTA_S)
    )
    velocity = (after - before) / (2 * _DELTA_S)
    return here, velocity, azimuth_elevation(places, here)[:, 1]


def _cn0_dbhz(
    table: SkyTable, given: float | None, elevation_deg: NDArray[np.float64]
) -> NDArray[np.float64]:
    """As the sky has it, NaN below the mask, (E,)."""
    zenith = table.cn0_zenith_dbhz if given is None else given
    low = zenith if given is not None or table.cn0_horizon_dbhz is None else table.cn0_horizon_dbhz
    sine = np.sin(np.radians(np.clip(elevation_deg, 0.0, None)))
    above = elevation_deg > table.elevation_mask_deg
    return np.where(above, low + (zenith - low) * sine, math.nan)
