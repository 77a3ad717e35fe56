"""The vehicle of an array: its motion from a file, and where its satellites should be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicSpline

from sdr_spoof.errors import AidingError, NavigationError
from sdr_spoof.nav.geodesy import azimuth_elevation, ecef_to_geodetic, enu_matrix
from sdr_spoof.nav.orbit import positions

from .examine import GRID_S, Vehicle
from .simulate import direction

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sdr_spoof.nav.store import Store
    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.scenario.sky.trajectory_files import Track

    Floats = NDArray[np.float64]

_ENU_TO_NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
_LOOK_S = 10.0
"""Satellites are looked for so often; in between their directions move evenly."""


def vehicle(
    track: Track, duration_s: float, store: Store | None = None, start: GnssTime | None = None
) -> Vehicle:
    """The vehicle at instants every :data:`.examine.GRID_S` of a recording.

    Args:
        track: positions and attitudes, times since the first sample.
        duration_s: length of the recording.
        store: ephemerides; None: satellites are taken to stand still.
        start: time of the first sample, which ephemerides need.

    Raises:
        AidingError: there are no attitudes, or the file and the recording do not overlap.
    """
    if track.attitude_rad is None:
        raise AidingError("an array needs attitudes: columns yaw_deg, pitch_deg and roll_deg")
    first = max(0.0, float(track.time_s[0]))
    last = min(duration_s, float(track.time_s[-1]))
    time_s = GRID_S * np.arange(np.ceil(first / GRID_S), np.floor(last / GRID_S) + 1)
    if time_s.size < 2:
        raise AidingError(
            f"the vehicle's file goes from {track.time_s[0]:g} to {track.time_s[-1]:g} s, the "
            f"recording from 0 to {duration_s:g} s: they do not overlap"
        )
    place_m = CubicSpline(track.time_s, track.position_m)(time_s)
    turned = CubicSpline(track.time_s, np.unwrap(track.attitude_rad, axis=0))(time_s)
    latitude, longitude, _ = ecef_to_geodetic(place_m[0])
    axes = _ENU_TO_NED @ enu_matrix(latitude, longitude)
    return Vehicle(
        time_s,
        turned,
        (place_m - place_m[0]) @ axes.T,
        _look(time_s, place_m, store, start),
    )


def _look(
    time_s: Floats, place_m: Floats, store: Store | None, start: GnssTime | None
) -> Callable[[str], Floats | None]:
    every = np.unique(
        np.append(np.arange(0, time_s.size, round(_LOOK_S / GRID_S)), time_s.size - 1)
    )

    def look(satellite: str) -> Floats | None:
        if store is None or start is None:
            return None
        middle = start + float(time_s[time_s.size // 2])
        selected = store.select(satellite[0], int(satellite[1:]), middle)
        if selected is None or selected.stale:
            return None
        try:
            orbit = positions(selected.ephemeris, [start + float(t) for t in time_s[every]])
        except NavigationError:
            return None
        unit = direction(*azimuth_elevation(place_m[every], orbit.position_m).T)
        return np.stack([np.interp(time_s, time_s[every], u) for u in unit.T], axis=-1)

    return look
