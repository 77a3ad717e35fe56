"""Pseudorange-rate consistency of each satellite: its change of phase against the INS and the rest.

The receiver's clock is the weighted mean of what all *other* satellites leave unexplained. Law
without an attack: N(0, s^2), s^2 from the noise of its own phase, that of the others' mean, and the
INS's variance along the difference of the lines of sight. An attack on all satellites shows in
each as far as its line of sight differs from the mean one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from sdr_spoof.detectors.series import StatisticSeries

from .growth import displacement_covariances
from .prepared import Prepared, prepare

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.config import Config

    Floats = NDArray[np.float64]

NAME = "rate_satellites"


def statistics(
    measurements: Measurements, states: InertialStates, config: Config
) -> Iterator[StatisticSeries]:
    """One series a satellite."""
    prepared = prepare(measurements, states, config.rate)
    value, sigma, noise = against_others(prepared)
    found = prepared.changes
    for column, name in enumerate(measurements.satellites):
        rows = (found.segment >= 0) & np.isfinite(value[:, column])
        yield StatisticSeries(
            detector=NAME,
            system=name[0],
            prn=int(name[1:]),
            unit="m/s",
            time_s=found.time_s[rows],
            value=value[rows, column],
            sigma=sigma[rows, column],
            sigma_thermal=noise[rows, column],
            segment=found.segment[rows],
            window_s=1.0,
            trace_time_s=found.time_s,
            trace=value[:, column],
            trace_unit="m/s of range, GNSS minus INS",
            trace_segment=np.where(rows, found.segment, -1),
            notes=found.notes,
            threshold_sigmas=float(norm.isf(config.rate.false_alarm_probability / 2)),
        )


def against_others(prepared: Prepared) -> tuple[Floats, Floats, Floats]:
    """Rate of each range against INS and the other satellites, its sigma and noise, (E, S) each."""
    found = prepared.changes
    there = np.isfinite(found.unexplained_m)
    weight = np.where(there, 1 / np.where(there, found.sigma_m, 1.0) ** 2, 0.0)
    others = weight.sum(axis=1, keepdims=True) - weight
    safe = np.where(others > 0, others, np.nan)
    measured = np.where(there, found.unexplained_m, 0.0) * weight
    clock = (measured.sum(axis=1, keepdims=True) - measured) / safe
    lines = np.where(there[..., None], found.line, 0.0) * weight[..., None]
    mean_line = (lines.sum(axis=1, keepdims=True) - lines) / safe[..., None]
    apart = found.line - mean_line
    moved = displacement_covariances(prepared.steps, prepared.covariance)
    drift = np.einsum("esi,eij,esj->es", apart, moved, apart)
    noise = 2 * (found.sigma_m**2 + 1 / safe)
    length = found.interval_s[:, None]
    value = (found.unexplained_m - clock) / length
    return value, np.sqrt(noise + drift) / length, np.sqrt(noise) / length
