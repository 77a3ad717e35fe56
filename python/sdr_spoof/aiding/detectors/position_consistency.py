"""Position consistency in east, north and up: the fix by code against a free INS.

The form that the rate form is compared with. Statistic: position by pseudoranges minus that of the
INS. Law without an attack: N(0, s^2), s^2 from the noise of the code and the variance that the
model of the INS gives its position. It sees steps and drags that have grown beyond both; the INS's
error grows without bound. A clock for each system is solved with it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from .changes import LARGEST_DOP, LEAST_SATELLITES, STRONG_DBHZ
from .growth import POSITION
from .prepared import DIRECTIONS, Prepared, in_direction, local, prepare

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.config import Config
    from sdr_spoof.detectors.series import StatisticSeries

    Floats = NDArray[np.float64]

NAME = "position_consistency"
PASSES = 3


def statistics(
    measurements: Measurements, states: InertialStates, config: Config
) -> Iterator[StatisticSeries]:
    """East, north and up."""
    prepared = prepare(measurements, states, config.rate)
    away, noise = against_ins(measurements, prepared, config.rate)
    axes = prepared.changes.axes
    east_north_up = np.einsum("eij,ej->ei", axes, away)
    code = np.sqrt(np.diagonal(local(axes, noise), axis1=1, axis2=2))
    ins = local(axes, prepared.covariance[:, POSITION, POSITION])
    drift = np.sqrt(np.diagonal(ins, axis1=1, axis2=2))
    for number in range(len(DIRECTIONS)):
        value, sigma = east_north_up[:, number], np.hypot(code, drift)[:, number]
        rows = np.isfinite(value) & np.isfinite(sigma)
        yield in_direction(
            NAME,
            number,
            rows,
            (value, sigma, code[:, number]),
            prepared.changes,
            window_s=1.0,
            trace=value,
            pfa=config.rate.false_alarm_probability,
            units=("m", f"m {DIRECTIONS[number]}, GNSS minus INS"),
            notes=_notes(rows, sigma, config.rate),
        )


def against_ins(
    measurements: Measurements, prepared: Prepared, config: RateConfig
) -> tuple[Floats, Floats]:
    """Fix minus INS, Earth-fixed (E, 3), and its covariance by noise (E, 3, 3)."""
    ranges, satellites = measurements.range_m, measurements.satellite_m
    weak = np.maximum(STRONG_DBHZ - measurements.cn0_dbhz, 0.0) / 20
    there = np.isfinite(ranges) & np.isfinite(satellites).all(axis=-1) & np.isfinite(weak)
    there &= measurements.cn0_dbhz >= config.min_cn0_dbhz
    there &= np.isfinite(prepared.ins.position_m[:, :1])
    weight = np.where(there, (config.code_sigma_m * 10 ** np.nan_to_num(weak)) ** -2.0, 0.0)
    clocks = _clocks(measurements.systems)
    place = prepared.ins.position_m
    away = np.zeros_like(place)
    for _ in range(PASSES):
        way = np.nan_to_num(satellites) - (place + away)[:, None]
        distance = np.linalg.norm(way, axis=-1)
        columns = np.broadcast_to(clocks, (*distance.shape, clocks.shape[1]))
        design = np.concatenate([np.nan_to_num(-way / distance[..., None]), columns], axis=-1)
        left = np.where(there, ranges - np.nan_to_num(distance), 0.0)
        moved, covariance = _solve(design, left, weight, there.sum(axis=1))
        away = away + moved
    return away, covariance


def _clocks(systems: tuple[str, ...]) -> Floats:
    """A column of ones for each system, (S, systems)."""
    letters = list(dict.fromkeys(systems))
    return np.array([[float(s == letter) for letter in letters] for s in systems])


def _solve(
    design: Floats, left: Floats, weight: Floats, count: NDArray[np.int64]
) -> tuple[Floats, Floats]:
    normal = np.einsum("esi,es,esj->eij", design, weight, design)
    # The clock of a system that is not received is nothing.
    silent = np.diagonal(normal, axis1=1, axis2=2) == 0.0
    silent &= np.arange(normal.shape[1]) >= 3
    normal += silent[:, :, None] * np.eye(normal.shape[1])
    scale = np.maximum(weight.max(axis=1), 1e-30)
    enough = (count >= LEAST_SATELLITES) & np.isfinite(normal).all(axis=(1, 2))
    normal[~enough] = np.eye(normal.shape[1])
    enough &= np.linalg.eigvalsh(normal)[:, 0] > np.minimum(scale, 1.0) / LARGEST_DOP**2
    normal[~enough] = np.eye(normal.shape[1])
    covariance = np.linalg.inv(normal)
    solution = np.einsum("eij,esj,es,es->ei", covariance, design, weight, left)
    solution[~enough], covariance[~enough] = np.nan, np.nan
    return solution[:, :3], covariance[:, :3, :3]


def _notes(rows: NDArray[np.bool_], sigma: Floats, config: RateConfig) -> tuple[str, ...]:
    if not rows.any():
        return ("no fix by code while the INS ran",)
    worst = float(sigma[rows].max() * norm.isf(config.false_alarm_probability / 2))
    return (f"at the end steps below {worst:.0f} m pass for drift of the INS",)
