"""Places by GNSS alone, every satellite believed: what a receiver without an INS would say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.sky.earth import enu_axes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import Measurements

PASSES = 8
"""From the centre of the Earth: each leaves the square of the last one's error over 2e7 m."""
STRONG_DBHZ = 45.0
LARGEST_DOP = 30.0
LEAST_SINE = 0.1


def places(measurements: Measurements) -> NDArray[np.float64]:
    """Earth-fixed antenna at each epoch by least squares of its pseudoranges, (E, 3).

    Weights are those of C/N0 and of the sine of the elevation; each system has a clock of its own.
    NaN where there are too few satellites or the geometry is poor.
    """
    m = measurements
    systems = sorted(set(m.systems))
    own = np.array([[s == system for system in systems] for s in m.systems], np.float64)
    there = np.isfinite(m.range_m) & np.isfinite(m.satellite_m).all(axis=-1)
    weight = there * 10.0 ** (np.clip(np.nan_to_num(m.cn0_dbhz), 20.0, STRONG_DBHZ) / 10.0)
    ranges, satellites = (
        np.where(there, m.range_m, 0.0),
        np.where(there[..., None], m.satellite_m, 1.0),
    )
    place, clocks = np.zeros((len(ranges), 3)), np.zeros((len(ranges), len(systems)))
    for number in range(PASSES):
        away = place[:, None] - satellites
        distance = np.linalg.norm(away, axis=-1)
        line = away / distance[..., None]
        if number > PASSES // 2:
            sine = np.einsum("esx,ex->es", -line, enu_axes(place)[:, 2])
            used = weight * np.clip(sine, LEAST_SINE, 1.0) ** 2
        else:
            used = weight
        design = np.concatenate([line, np.broadcast_to(own, (*there.shape, len(systems)))], axis=-1)
        left = ranges - distance - clocks @ own.T
        step, dop = _solved(design, left, used)
        place, clocks = place + step[:, :3], clocks + step[:, 3:]
    enough = there.sum(axis=1) >= 3 + (there[..., None] & (own > 0)).any(axis=1).sum(axis=1)
    return np.where((enough & (dop < LARGEST_DOP))[:, None], place, np.nan)


def _solved(
    design: NDArray[np.float64], left: NDArray[np.float64], weight: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Steps (E, 3 + C), and PDOP with equal weights (E,); systems without satellites stay."""
    normal = np.einsum("esi,es,esj->eij", design, weight, design)
    scale = np.maximum(weight.max(axis=1), 1e-9)
    # A clock nobody asks for must not make the matrix singular.
    normal += 1e-9 * scale[:, None, None] * np.eye(design.shape[-1])
    right = np.einsum("esi,es->ei", design, weight * left)
    step = np.linalg.solve(normal, right[..., None])[..., 0]
    plain = np.einsum("esi,es,esj->eij", design, weight > 0, design)
    inverse = np.linalg.inv(plain + 1e-9 * np.eye(design.shape[-1]))
    return step, np.sqrt(np.abs(np.einsum("eii->ei", inverse)[:, :3].sum(axis=1)))


def velocities(measurements: Measurements, place_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Earth-fixed velocity at each epoch by least squares of the rates, (E, 3).

    Args:
        measurements: of the antenna.
        place_m: where it is, (E, 3); a kilometre off costs 0.1 m/s.
    """
    m = measurements
    there = np.isfinite(m.rate_m_s) & np.isfinite(m.satellite_m).all(axis=-1)
    there &= np.isfinite(place_m).all(axis=1, keepdims=True)
    away = np.where(there[..., None], place_m[:, None] - m.satellite_m, 1.0)
    line = away / np.linalg.norm(away, axis=-1, keepdims=True)
    still = np.einsum("esx,esx->es", line, -np.nan_to_num(m.satellite_velocity_m_s))
    design = np.concatenate([line, np.ones((*there.shape, 1))], axis=-1)
    left = np.where(there, m.rate_m_s - still, 0.0)
    found, dop = _solved(design, left, there.astype(np.float64))
    enough = (there.sum(axis=1) >= 4) & (dop < LARGEST_DOP)
    return np.where(enough[:, None], found[:, :3], np.nan)
