"""Pseudorange-rate consistency in east, north and up: GNSS against a free INS.

Statistic: mean, over K epochs, of the velocity by carrier phase minus that of the INS over the same
interval (:mod:`.changes`). Law without an attack: N(0, s^2) with s^2 the noise of two phases,
divided by K^2, plus the variance that the model of the INS gives its velocity (:mod:`.growth`).
K is the fewest that finds ``drag_m_s`` with ``detection_probability``; where none is enough, the
INS is too old and nothing is judged. Chang et al., J. Air Force Engineering University 23 (4),
2022, equations 17 to 27, where the variance of the INS is left out: see ``reproduce ins-rate``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .growth import displacement_covariances
from .power import fewest
from .prepared import DIRECTIONS, Prepared, in_direction, local, prepare, too_old

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.config import Config
    from sdr_spoof.detectors.series import StatisticSeries

    from .changes import Changes

    Floats = NDArray[np.float64]

NAME = "rate_consistency"


def statistics(
    measurements: Measurements, states: InertialStates, config: Config
) -> Iterator[StatisticSeries]:
    """East, north and up."""
    prepared = prepare(measurements, states, config.rate)
    for number in range(len(DIRECTIONS)):
        yield series(prepared, number, config.rate)


def series(prepared: Prepared, number: int, config: RateConfig) -> StatisticSeries:
    """The statistic of one direction (0 east, 1 north, 2 up)."""
    found = prepared.changes
    length = found.interval_s
    rate = found.displacement_m[:, number] / length
    noise = np.sqrt(2 * found.covariance_m2[:, number, number]) / length
    drift = np.sqrt(_ins_variance(prepared)[:, number]) / length
    possible = (found.segment >= 0) & np.isfinite(rate)
    pfa, pd = config.false_alarm_probability / len(DIRECTIONS), config.detection_probability
    enough = fewest(config.drag_m_s, noise, drift, pfa, pd, config.most_samples)
    samples = np.ones_like(enough) if config.samples == "one" else enough
    value, there = _means(np.where(possible, found.displacement_m[:, number], 0.0), found, samples)
    supported = possible & there & (enough > 0 if config.samples == "fewest" else True)
    noise = noise / np.maximum(samples, 1)
    note = too_old(enough > 0, possible, found) if config.samples == "fewest" else None
    return in_direction(
        NAME,
        number,
        supported,
        (value, np.hypot(noise, drift), noise),
        found,
        window_s=float(np.nanmax(np.where(supported, samples * length, np.nan), initial=1.0)),
        trace=rate,
        pfa=config.false_alarm_probability,
        units=("m/s", f"m/s {DIRECTIONS[number]}, GNSS minus INS"),
        notes=found.notes + ((note,) if note else ()),
    )


def _ins_variance(prepared: Prepared) -> Floats:
    """Of the displacement by the INS over each interval, in east, north, up (E, 3)."""
    moved = displacement_covariances(prepared.steps, prepared.covariance)
    return np.diagonal(local(prepared.changes.axes, moved), axis1=-2, axis2=-1)


def _means(
    moved: Floats, found: Changes, samples: NDArray[np.int64]
) -> tuple[Floats, NDArray[np.bool_]]:
    """Rate over the last ``samples`` epochs of the same piece, and where there are as many."""
    time_s, segment = found.time_s, found.segment
    total = np.concatenate([[0.0], np.cumsum(moved)])
    row = np.arange(moved.size)
    first = row - samples + 1
    there = (first >= 1) & (samples > 0)
    first = np.clip(first, 1, None)
    there &= segment[np.minimum(first, row)] == segment
    length = time_s - time_s[np.minimum(first, row) - 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        return (total[row + 1] - total[np.minimum(first, row)]) / length, there
