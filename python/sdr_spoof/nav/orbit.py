"""Satellite positions and clocks from broadcast ephemerides; the arithmetic is in the core."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from ..errors import NavigationError
from .beidou_satellites import GEO
from .ephemeris import Ephemeris

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from .time import GnssTime

GPS_MODEL, BDS_MODEL, BDS_GEO_MODEL = 0.0, 1.0, 2.0


@dataclass(frozen=True)
class SatelliteStates:
    """N satellites at instants of transmission."""

    position_m: NDArray[np.float64]
    """(N, 3), Earth-fixed at the instant of transmission; the Earth turns until reception."""
    velocity_m_s: NDArray[np.float64]
    """(N, 3), in the rotating frame."""
    clock_s: NDArray[np.float64]
    """(N,): satellite clock minus system time, with relativity, without group delay."""
    clock_drift: NDArray[np.float64]
    """(N,): its rate."""


def positions(
    ephemerides: Ephemeris | Sequence[Ephemeris], times: Sequence[GnssTime]
) -> SatelliteStates:
    """States at instants of system time: of one satellite at all, or pair by pair.

    Raises:
        NavigationError: if an ephemeris is of a system without an orbit model, or describes none.
    """
    if not times:
        return states([], np.zeros(0, np.int64), np.zeros(0), None)
    reference = times[0]
    time_s = np.array([t - reference for t in times])
    if isinstance(ephemerides, Ephemeris):
        return states([ephemerides], np.zeros(len(times), np.int64), time_s, reference)
    return states(ephemerides, np.arange(len(times)), time_s, reference)


def states(
    ephemerides: Sequence[Ephemeris], row: ArrayLike, time_s: ArrayLike, reference: GnssTime | None
) -> SatelliteStates:
    """States by index into ``ephemerides`` (N,) at seconds after a reference (N,).

    Raises:
        NavigationError: as :func:`positions`.
    """
    rows = np.ascontiguousarray(row, np.int64)
    times = np.ascontiguousarray(time_s, np.float64)
    try:
        return SatelliteStates(*_core.satellite_states(table(ephemerides, reference), rows, times))
    except ValueError as error:
        raise NavigationError(str(error)) from error


def table(ephemerides: Sequence[Ephemeris], reference: GnssTime | None) -> NDArray[np.float64]:
    """Ephemerides as the core takes them, one a row, times counted from a reference.

    Raises:
        NavigationError: if one is of a system without an orbit model.
    """
    if not ephemerides or reference is None:
        return np.zeros((0, 24))
    return np.array([_row(ephemeris, reference) for ephemeris in ephemerides])


def _row(e: Ephemeris, reference: GnssTime) -> list[float]:
    return [
        _model(e),
        e.toe - reference,
        e.toe.week_tow(e.system)[1],
        e.toc - reference,
        *(e.a0, e.a1, e.a2, e.a, e.a_dot, e.e, e.m0, e.delta_n, e.delta_n_dot),
        *(e.omega0, e.i0, e.omega, e.omega_dot, e.i_dot),
        *(e.cuc, e.cus, e.crc, e.crs, e.cic, e.cis),
    ]


def _model(e: Ephemeris) -> float:
    if e.system == "C":
        return BDS_GEO_MODEL if e.prn in GEO else BDS_MODEL
    if e.system in "GJ":
        return GPS_MODEL
    raise NavigationError(f"satellite {e.system}{e.prn:02d}: its system has no orbit model")
