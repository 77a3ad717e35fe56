"""From phase differences to directions, freed from how the vehicle is turned.

Each epoch gives the direction to the source along the array's axes (paper, equation 4). A plane
array leaves the part along its normal open; the direction is of unit length and from above, which
gives it. Turned by the whole attitude of the INS, the directions of all epochs can be compared
(the paper turns by yaw alone, equation 11).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.sky.trajectory import rotations

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .geometry import AntennaArray
    from .phases import ArrayPhases

LOWEST = 0.02
"""Least part of a direction along the normal, where noise makes the rest longer than 1."""
MARGIN_SIGMAS = 4.0
"""By so much a direction may be longer than 1 and count as one."""


@dataclass(frozen=True)
class Directions:
    """Directions of E epochs with their covariance; runs lead."""

    unit: NDArray[np.float64]
    """North, east, down, (..., E, 3)."""
    level: NDArray[np.float64]
    """North and east, less what the satellite is expected to have moved, (..., E, 2)."""
    covariance: NDArray[np.float64]
    """Of ``level`` over all epochs, (..., 2 E, 2 E)."""
    admissible: NDArray[np.bool_]
    """Whether all are directions at all, no longer than 1, (...)."""


def directions(
    array: AntennaArray, phases: ArrayPhases, whole_cycles: NDArray[np.float64] | None = None
) -> Directions:
    """Directions if the phase differences hold so many whole cycles (A - 1,)."""
    measured = phases.difference_cycles
    if whole_cycles is not None:
        measured = measured - whole_cycles
    read = array.read(phases.wavelength_m)
    along = measured @ read.T
    turn = rotations(phases.attitude_rad)
    noise = array.covariance(phases.sigma_cycles, phases.wavelength_m)
    square = np.sum(along**2, axis=-1)
    body = along @ array.axes
    slope = np.broadcast_to(array.axes.T, (*along.shape[:-1], 3, len(array.axes)))
    if array.up is not None:
        height = np.sqrt(np.maximum(1.0 - square, LOWEST**2))
        body = body + height[..., None] * array.up
        slope = slope - array.up[:, None] * (along / height[..., None])[..., None, :]
    unit = np.einsum("eij,...ej->...ei", turn, body)
    level = unit[..., :2]
    if phases.expected is not None:
        level = level - (phases.expected[:, :2] - phases.expected[0, :2])
    jacobian = np.einsum("eij,...ejd->...eid", turn, slope)[..., :2, :]
    return Directions(
        unit,
        level,
        _covariance(jacobian, noise, read, unit, phases),
        np.all(square <= _longest(noise) ** 2, axis=-1),
    )


def _covariance(
    jacobian: NDArray[np.float64],
    noise: NDArray[np.float64],
    read: NDArray[np.float64],
    unit: NDArray[np.float64],
    phases: ArrayPhases,
) -> NDArray[np.float64]:
    """Phase noise by itself at each epoch; yaw that walks away from the first; delays for good."""
    epochs = phases.time_s.size
    lead = unit.shape[:-2]
    each = jacobian @ noise @ np.swapaxes(jacobian, -1, -2)
    total = np.zeros((*lead, epochs, 2, epochs, 2))
    for k in range(epochs):
        total[..., k, :, k, :] = each[..., k, :, :]
    if phases.yaw_sigma_rad:
        across = np.stack([-unit[..., 1], unit[..., 0]], axis=-1)
        since = (phases.time_s - phases.time_s[0]) / (phases.time_s[-1] - phases.time_s[0])
        walk = phases.yaw_sigma_rad**2 * np.minimum.outer(since, since)
        total += np.einsum("kl,...ka,...lb->...kalb", walk, across, across)
    if phases.bias_sigma_cycles:
        factor = phases.bias_sigma_cycles * jacobian @ read
        total += np.einsum("...kam,...lbm->...kalb", factor, factor)
    return total.reshape(*lead, 2 * epochs, 2 * epochs)


def whole_cycles(array: AntennaArray, phases: ArrayPhases) -> NDArray[np.float64]:
    """Whole cycles that some run's first epoch may hold, (C, A - 1): its direction is one.

    One row of zeros where they are known. About 11 fit each run at sides of two wavelengths.
    """
    if phases.known_cycles:
        return np.zeros((1, phases.difference_cycles.shape[-1]))
    first = phases.difference_cycles[..., 0, :].reshape(-1, phases.difference_cycles.shape[-1])
    reach = np.linalg.norm(array.baselines_m, axis=1) / phases.wavelength_m
    reach = reach + MARGIN_SIGMAS * phases.sigma_cycles
    step = phases.cycle_step
    low = np.floor((first.min(axis=0) - reach) / step)
    high = np.ceil((first.max(axis=0) + reach) / step)
    spans = (step * np.arange(a, b + 1) for a, b in zip(low, high, strict=True))
    grid = np.array(list(product(*spans)))
    read = array.read(phases.wavelength_m)
    longest = _longest(array.covariance(phases.sigma_cycles, phases.wavelength_m))
    fits = [bool(np.any(np.linalg.norm((first - n) @ read.T, axis=1) <= longest)) for n in grid]
    return np.asarray(grid[fits])


def _longest(noise: NDArray[np.float64]) -> float:
    """What a direction of that covariance may measure and be one."""
    return 1.0 + MARGIN_SIGMAS * float(np.sqrt(np.linalg.eigvalsh(noise)[-1]))
