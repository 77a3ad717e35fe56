"""Drags of any direction that an INS, whose errors the filter learns, cannot explain.

The statistic is that of :mod:`.drag_filter`: a generalised likelihood ratio over the onset. Law
without an attack: chi-square of three degrees of freedom for each onset; the value given is the
two-sided normal quantile of its probability, and the threshold that of ``false_alarms_per_hour``
over all onsets and epochs. It needs no fresh alignment: the satellites teach it, and a drag that is
slower than what the INS may do of itself passes for drift.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2, norm

from sdr_spoof.detectors.series import StatisticSeries

from .drag_filter import Displacements, Searched, search
from .growth import Steps
from .prepared import ALL_SATELLITES, Prepared, prepare

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.config import Config

    Floats = NDArray[np.float64]

NAME = "rate_drag"
INDEPENDENT = 12.0
"""Independent onsets an epoch: what the rate of false alarms is over that of one chi-square. By
simulation of 5800 hours it is 4 at 1.2 alarms an hour and 6 at 0.005; see docs/validation.md."""


def statistics(
    measurements: Measurements, states: InertialStates, config: Config
) -> Iterator[StatisticSeries]:
    """One series, of all directions together."""
    yield series(prepare(measurements, states, config.rate), config.rate)


def threshold(config: RateConfig, epoch_s: float) -> float:
    """Of the likelihood ratio, for the configured false alarms an hour."""
    return float(chi2.isf(config.false_alarms_per_hour * epoch_s / 3600 / INDEPENDENT, 3))


def searched(prepared: Prepared, config: RateConfig, epoch_s: float) -> Searched:
    """The search through one recording."""
    found, steps = prepared.changes, prepared.steps
    usable = found.segment >= 0
    moved = np.einsum("eij,ei->ej", found.axes, np.nan_to_num(found.displacement_m))
    noise = np.swapaxes(found.axes, 1, 2) @ np.nan_to_num(found.covariance_m2) @ found.axes
    given = Displacements(
        found.time_s,
        moved[None, None],
        noise[None],
        usable & np.concatenate([[True], ~usable[:-1]]),
        usable,
        found.same_set,
    )
    one = Steps(
        steps.transition[None],
        steps.noise[None],
        steps.start[None],
        steps.gained[None],
        steps.aligned,
    )
    return search(given, one, max(2, round(config.onset_window_s / epoch_s)))


def series(prepared: Prepared, config: RateConfig) -> StatisticSeries:
    """The statistic as a rule takes it."""
    found = prepared.changes
    lengths = found.interval_s[np.isfinite(found.interval_s)]
    epoch_s = float(np.median(lengths)) if lengths.size else 1.0
    result = searched(prepared, config, epoch_s)
    ratio, limit = result.statistic[0, 0], threshold(config, epoch_s)
    least = config.drag_m_s / (np.sqrt(limit) + float(norm.isf(1 - config.detection_probability)))
    possible = np.isfinite(ratio)
    rows = possible & (result.sigma_m_s[0] <= least)
    notes = list(found.notes)
    if (possible & ~rows).any():
        notes.append(
            f"{int((possible & ~rows).sum())} of {int(possible.sum())} epochs not judged: a drag "
            f"of {config.drag_m_s:g} m/s would not be found with probability "
            f"{config.detection_probability:g}"
        )
    value = as_sigmas(ratio)
    moved = _along(prepared, result)
    return StatisticSeries(
        detector=NAME,
        system=ALL_SATELLITES[0],
        prn=ALL_SATELLITES[1],
        unit="sigma",
        time_s=found.time_s[rows],
        value=value[rows],
        sigma=np.ones(int(rows.sum())),
        sigma_thermal=np.ones(int(rows.sum())),
        segment=found.segment[rows],
        window_s=config.onset_window_s,
        trace_time_s=found.time_s,
        trace=moved,
        trace_unit="m along the largest drag, GNSS minus INS",
        trace_segment=found.segment,
        notes=tuple(notes),
        quantity="any direction",
        shortest_s=epoch_s,
        threshold_sigmas=float(as_sigmas(np.array(limit))),
    )


def as_sigmas(ratio: Floats) -> Floats:
    """Two-sided normal quantile of the probability of a chi-square of three."""
    return np.asarray(norm.isf(np.clip(chi2.sf(ratio, 3), 1e-300, 1.0) / 2))


def _along(prepared: Prepared, result: Searched) -> Floats:
    """Sum of the displacements in the direction of the drag at the largest statistic, (E,)."""
    found = prepared.changes
    if not np.isfinite(result.statistic).any():
        return np.zeros(found.time_s.size)
    drag = result.drag_m_s[0, 0, int(np.nanargmax(result.statistic[0, 0]))]
    direction = drag / max(float(np.linalg.norm(drag)), 1e-12)
    moved = np.einsum("eij,ei,j->e", found.axes, np.nan_to_num(found.displacement_m), direction)
    return np.asarray(np.cumsum(moved))
