"""Simulated phases of an array: satellites far away, spoofers near by."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.sky.trajectory import rotations

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .geometry import AntennaArray

    Floats = NDArray[np.float64]


def direction(azimuth_deg: ArrayLike, elevation_deg: ArrayLike) -> Floats:
    """Unit vectors north, east, down (..., 3) of angles (...)."""
    a, e = np.broadcast_arrays(np.radians(azimuth_deg), np.radians(elevation_deg))
    return np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), -np.sin(e)], axis=-1)


def towards(source_m: Floats, displacement_m: Floats) -> Floats:
    """Directions (..., E, 3) to a source that stands at a place (..., 3) seen from the first epoch.

    Args:
        source_m: north, east, down from the array's place at the first epoch, m.
        displacement_m: of the array since then, (E, 3), m.
    """
    way = np.asarray(source_m)[..., None, :] - displacement_m
    return np.asarray(way / np.linalg.norm(way, axis=-1, keepdims=True))


def differences(
    array: AntennaArray,
    unit: Floats,
    attitude_rad: Floats,
    wavelength_m: float,
    sigma_cycles: float,
    rng: np.random.Generator,
    *,
    bias_cycles: Floats | float = 0.0,
    whole_cycles: bool = True,
) -> Floats:
    """Phase differences (..., E, A - 1) of a plane wave from given directions.

    Args:
        array: the antennas.
        unit: directions north, east, down, (..., E, 3).
        attitude_rad: true yaw, pitch, roll, (E, 3) or (..., E, 3).
        wavelength_m: of the carrier.
        sigma_cycles: noise of one antenna's phase.
        rng: source of the noise.
        bias_cycles: delays of the lines, (..., A - 1).
        whole_cycles: whether the receiver knows them; else the first epoch is within half a cycle.
    """
    flat = np.broadcast_to(attitude_rad, (*unit.shape[:-1], 3)).reshape(-1, 3)
    body = np.einsum("nij,ni->nj", rotations(flat), unit.reshape(-1, 3)).reshape(unit.shape)
    exact = -body @ array.baselines_m.T / wavelength_m
    noise = sigma_cycles * rng.standard_normal((*exact.shape[:-1], exact.shape[-1] + 1))
    measured = exact + noise[..., 1:] - noise[..., :1] + np.atleast_1d(bias_cycles)[..., None, :]
    if not whole_cycles:
        measured = measured - np.round(measured[..., :1, :])
    return np.asarray(measured)
