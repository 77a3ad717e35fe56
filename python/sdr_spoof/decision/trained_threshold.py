"""A threshold trained on the first part of a series: what comes later is held against that.

The first ``training`` samples, taken to be clean, tell the mean m and the deviation s, or s alone;
each later sample x has |x - m| / (s sqrt(1 + 1 / n)), Student's t of n - 1 degrees of freedom under
H0 (|x| / s and n where the mean is known to be zero), so that the threshold of a stated probability
is exact for independent normal samples however few there were (Hahn and Meeker, Statistical
Intervals, 1991, prediction of one more sample). Of the deviation that a detector states only the
course matters, not the size.

Blind to an attack that is there while it trains: it becomes the normal state, and its *end* alarms;
and to whatever is smaller than the scatter of one sample, since nothing is added up. It holds for
as long as the series stays what it was: a free INS does not. Its drift leaves any mean of the first
minutes within the next ones, and every epoch after that is a false alarm (docs/validation.md);
there take :mod:`.local_mean`, or a detector whose law contains the errors of the INS.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.stats import norm, t

from sdr_spoof.decision.onset import onset_time
from sdr_spoof.decision.record import Decision, Refusal
from sdr_spoof.decision.rule import Change, SequentialRule, checked
from sdr_spoof.detectors.series import LOG10_P_FLOOR

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.detectors.config import DetectionConfig
    from sdr_spoof.detectors.series import StatisticSeries

    Floats = NDArray[np.float64]

LEAST_SAMPLES = 10
"""Independent samples without which nothing is trained."""


@dataclass(frozen=True)
class Parameters:
    """How long it trains, and what it learns."""

    training: int = 100
    """Samples from the first on."""
    mean: Literal["trained", "zero"] = "trained"
    """Learned as the deviation is, or known to be zero."""

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        checked("trained-threshold", training=(self.training, 2))

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the statistic's law."""
        return self.training - (self.mean == "trained")


def path(z: Floats, parameters: Parameters) -> Floats:
    """Size of t of each sample after the training; zero within it."""
    there = np.isfinite(z)
    number = np.cumsum(there, axis=-1)
    training = there & (number <= parameters.training)
    known = np.where(there, z, 0.0)
    centre, scale = _learned(known, training, parameters)
    found = np.where(training, 0.0, np.abs(known - centre) / scale)
    found[~there] = np.nan
    return np.asarray(found)


def _learned(known: Floats, training: NDArray[np.bool_], of: Parameters) -> tuple[Floats, Floats]:
    """Mean and deviation of one more sample, (..., 1) each; infinite until the training is over."""
    count = np.maximum(training.sum(-1, keepdims=True), 1)
    # Running sums, so that gaps do not change their order.
    if of.mean == "zero":
        centre, freedom, wider = np.zeros(count.shape), count, 1.0
    else:
        centre = _total(np.where(training, known, 0.0)) / count
        freedom, wider = np.maximum(count - 1, 1), np.sqrt(1.0 + 1.0 / count)
    square = _total(np.where(training, (known - centre) ** 2, 0.0))
    scale = np.maximum(np.sqrt(square / freedom), np.finfo(float).tiny) * wider
    return centre, np.where(count == of.training, scale, np.inf)


def _total(values: Floats) -> Floats:
    if values.shape[-1] == 0:
        return np.zeros((*values.shape[:-1], 1))
    return np.asarray(np.cumsum(values, axis=-1)[..., -1:])


def decide(series: StatisticSeries, config: DetectionConfig) -> Decision | Refusal | None:
    """Fires at the first row after the training whose t has less than the stated probability.

    Of the training rows one a window is used: rows of overlapping windows repeat each other.
    """
    if series.value.size == 0:
        return None
    since_s = series.time_s - series.time_s[0]
    trained = _apart(since_s, config.rule_training_s, series.window_s)
    if trained.size < LEAST_SAMPLES:
        return Refusal(
            f"rule 'trained-threshold' does not judge: {trained.size} independent samples in the "
            f"{config.rule_training_s:g} s of training, {LEAST_SAMPLES} are needed; make "
            "rule_training_s longer"
        )
    parameters = replace(Parameters(), training=trained.size, mean=config.rule_training_mean)
    later = np.flatnonzero(since_s >= config.rule_training_s)
    row = np.concatenate([trained, later])
    size = path(series.value[row] / series.sigma[row], parameters)[trained.size :]
    threshold = float(t.isf(_per_test(series, config) / 2.0, parameters.freedom))
    beyond = np.flatnonzero(size > threshold)
    if beyond.size == 0:
        return None
    first = int(later[beyond[0]])
    held = (later >= first) & (series.time_s[later] <= series.time_s[first] + series.window_s)
    peak = float(np.nanmax(size[held]))
    log10_p = float((t.logsf(peak, parameters.freedom) + np.log(2.0)) / np.log(10.0))
    return Decision(
        alarm_s=float(series.time_s[first]),
        onset_s=onset_time(series, first, config.onset_lookback_s),
        statistic=peak,
        threshold=threshold,
        log10_p=float(np.clip(log10_p, LOG10_P_FLOOR, 0.0)),
        unit="trained sigma",
    )


def _per_test(series: StatisticSeries, config: DetectionConfig) -> float:
    """Probability that the detector's own law allows one test, or the configured one."""
    if series.threshold_sigmas is not None:
        return float(2.0 * norm.sf(series.threshold_sigmas))
    return config.false_alarm_probability * series.share


def _apart(since_s: Floats, until_s: float, window_s: float) -> NDArray[np.int64]:
    """First row of each stretch of a window before ``until_s``."""
    rows = np.flatnonzero(since_s < until_s)
    number = np.floor(since_s[rows] / max(window_s, 1e-9) + 5e-7).astype(np.int64)
    return np.asarray(rows[np.unique(number, return_index=True)[1]])


RULE = SequentialRule(
    "trained-threshold",
    "Threshold trained on the first part",
    "whether one test is beyond what those of the first part explain",
    path,
    Parameters(),
    lambda _: Change(template=(1.0,), sizes=(3.5, 5.0, 7.0, 9.0)),
    "deviate",
    decide=decide,
)
