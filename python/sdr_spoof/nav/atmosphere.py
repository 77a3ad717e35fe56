"""Delays of the atmosphere along rays; the arithmetic is in the core.

All functions take N rays: ``place`` (N, 3) or (3,), latitude and longitude in degrees and height
in m; ``direction`` (N, 2), azimuth and elevation in degrees; and one instant for all, or GPST
since 1980-01-06 in s (N,), as :func:`gpst_s` gives it. They give the delay of a
code in m (N,); the phase of a carrier is advanced by as much as its code is delayed by the
ionosphere.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import _core
from .broadcast import Bdgim, Klobuchar
from .geodesy import radians
from .time import GnssTime

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from .broadcast import Ionosphere

    Times = GnssTime | NDArray[np.float64]


def gpst_s(reference: GnssTime, time_s: ArrayLike) -> NDArray[np.float64]:
    """GPST since 1980-01-06 in s of instants after a reference: good to 0.1 microseconds."""
    return reference.seconds + reference.fraction + np.asarray(time_s, np.float64)


def ionosphere_m(
    model: Ionosphere | None,
    place: ArrayLike,
    direction: ArrayLike,
    times: Times,
    carrier_hz: float,
) -> NDArray[np.float64]:
    """Ionospheric delay by broadcast parameters at a carrier; 0 without a model.

    Klobuchar in GPS's or BDS's form (by ``model.system``), or BDGIM with the fixed coefficients
    of BDS-SIS-ICD-B1C-1.0.
    """
    rays, instants = _rays(place, direction, times)
    return _core.ionosphere_m(*core_model(model), *rays, instants, carrier_hz)


def troposphere_m(place: ArrayLike, direction: ArrayLike, times: Times) -> NDArray[np.float64]:
    """Tropospheric delay: Saastamoinen in a standard atmosphere, mapped by Niell (3 degrees up)."""
    rays, instants = _rays(place, direction, times)
    return _core.troposphere_m(*rays, instants)


def core_model(model: Ionosphere | None) -> tuple[str, Sequence[float]]:
    """Name and parameters as the core takes them."""
    if isinstance(model, Klobuchar):
        return model.system, (*model.alpha, *model.beta)
    if isinstance(model, Bdgim):
        return "bdgim", model.alpha
    return "none", ()


def _rays(
    place: ArrayLike, direction: ArrayLike, times: Times
) -> tuple[tuple[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]:
    looks = np.radians(np.ascontiguousarray(direction, np.float64).reshape(-1, 2))
    places = np.ascontiguousarray(np.broadcast_to(radians(place), (len(looks), 3)))
    instants = gpst_s(times, 0.0) if isinstance(times, GnssTime) else np.asarray(times, np.float64)
    return (places, looks), np.ascontiguousarray(np.broadcast_to(instants, (len(looks),)))
