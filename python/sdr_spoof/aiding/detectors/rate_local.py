"""Local rate test: a mean of the rate against a line through the minute before, INS errors with it.

Statistic: :mod:`.local_mean` of the velocity by carrier phase minus that of the INS, in east, north
and up. Law without an attack: N(0, s^2); s^2 is the noise of the phases under these weights, and
what the model of the INS errors leaves of them: little on a straight way, more in a turn, where an
error of the heading that nothing has shown before becomes an error of velocity. It sees the
beginning and the end of a drag, and must latch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import local_mean
from .growth import POSITION, STATES
from .prepared import DIRECTIONS, Prepared, in_direction, prepare

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.config import Config
    from sdr_spoof.detectors.series import StatisticSeries

    from .growth import Steps

    Floats = NDArray[np.float64]

NAME = "rate_local"


def statistics(
    measurements: Measurements, states: InertialStates, config: Config
) -> Iterator[StatisticSeries]:
    """East, north and up."""
    prepared = prepare(measurements, states, config.rate)
    mean, baseline = lengths(prepared, config.rate)
    drift = ins_variance(prepared.steps, prepared.covariance, mean, baseline)
    for number in range(len(DIRECTIONS)):
        yield _series(prepared, number, (mean, baseline), drift, config.rate)


def lengths(prepared: Prepared, config: RateConfig) -> tuple[int, int]:
    """Epochs of the mean and of the baseline."""
    steps = prepared.changes.interval_s[np.isfinite(prepared.changes.interval_s)]
    epoch_s = float(np.median(steps)) if steps.size else 1.0
    return max(1, round(config.mean_s / epoch_s)), max(3, round(config.baseline_s / epoch_s))


def ins_variance(steps: Steps, covariance: Floats, mean: int, baseline: int) -> Floats:
    """Covariance of the statistic that errors of the INS make, of displacements in m, (E, 3, 3).

    Backwards through the window: each epoch's weight on its position error goes through the
    transitions to the state before the window.
    """
    parts = local_mean.weights(mean, baseline)
    on_position = parts - np.append(parts[1:], 0.0)
    epochs = covariance.shape[0]
    ends = np.arange(parts.size, epochs)
    found = np.full((epochs, 3, 3), np.nan)
    if ends.size == 0:
        return found
    effect = np.zeros((ends.size, 3, STATES))
    total = np.zeros((ends.size, 3, 3))
    for back in range(parts.size):
        row = ends - back
        effect[:, :, POSITION] += on_position[-1 - back] * np.eye(3)
        total += effect @ steps.noise[row] @ np.swapaxes(effect, 1, 2)
        effect = effect @ steps.transition[row]
    effect[:, :, POSITION] -= parts[0] * np.eye(3)
    before = covariance[ends - parts.size]
    found[ends] = total + effect @ before @ np.swapaxes(effect, 1, 2)
    return found


def _series(
    prepared: Prepared, number: int, size: tuple[int, int], drift: Floats, config: RateConfig
) -> StatisticSeries:
    found = prepared.changes
    length = found.interval_s
    rate = found.displacement_m[:, number] / length
    value = local_mean.statistic(rate, *size)
    whole = _whole(found.segment, sum(size))
    noise = found.covariance_m2[:, number, number] * 2 * local_mean.variance_factor(*size)
    axis = found.axes[:, number]
    carried = np.einsum("ei,eij,ej->e", axis, drift, axis)
    sigma = np.sqrt(noise + carried) / length
    supported = whole & np.isfinite(value) & np.isfinite(sigma)
    notes = found.notes
    if not supported.any():
        notes += (f"no piece of {config.mean_s + config.baseline_s:g} s without a break",)
    return in_direction(
        NAME,
        number,
        supported,
        (value, sigma, np.sqrt(noise) / length),
        found,
        window_s=config.mean_s,
        trace=rate,
        pfa=config.false_alarm_probability,
        units=("m/s", f"m/s {DIRECTIONS[number]}, GNSS minus INS"),
        notes=notes,
    )


def _whole(segment: NDArray[np.int64], rows: int) -> NDArray[np.bool_]:
    """Where so many epochs up to this one are of one piece."""
    row = np.arange(segment.size) - rows + 1
    return np.asarray((row >= 0) & (segment >= 0) & (segment[np.clip(row, 0, None)] == segment))
