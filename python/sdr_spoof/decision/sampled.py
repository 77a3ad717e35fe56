"""A sequential rule on the series of any detector.

Rules add up independent samples, and a detector's windows overlap from row to row. Of each stretch
of one window, therefore, one sample is taken: the test that ends with it or, where a detector has
windows of several lengths and a threshold for all of them, the most significant test within it,
worth as much as the largest of as many independent tests as its threshold counts. The rule's own
threshold is calibrated for one sample a window and the rate of false alarms of the configuration.

The first samples (a third, at most :data:`BASELINE`) tell whether the rest may be judged, see
:mod:`.whitening`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import log_ndtr, ndtri_exp
from scipy.stats import chi2

from sdr_spoof.decision.calibration import threshold_for
from sdr_spoof.decision.onset import MIN_BEFORE, onset_time
from sdr_spoof.decision.record import Decision, Refusal
from sdr_spoof.decision.rule import SequentialRule, first_alarm
from sdr_spoof.decision.whitening import LEAST_SAMPLES, fit, whiten
from sdr_spoof.detectors.series import LOG10_P_FLOOR

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.detectors.config import DetectionConfig
    from sdr_spoof.detectors.series import StatisticSeries

BASELINE = 120
"""Most samples that are looked at before the tests begin."""
QUIET = 0.1
"""Share of the threshold below which the statistic has not begun to climb."""
UNITS = {"log-likelihood": "(log-likelihood)", "deviate": "sigma", "squares": "(squares)"}


@dataclass(frozen=True)
class Samples:
    """Independent samples of a series, K in all."""

    z: NDArray[np.float64]
    """In standard deviations, signed, (K,)."""
    row: NDArray[np.int64]
    """Row of the series that each is of, (K,)."""
    spacing_s: float


def decide(
    rule: SequentialRule[Any], series: StatisticSeries, config: DetectionConfig
) -> Decision | Refusal | None:
    """Fires at the first sample at which the rule's statistic exceeds its threshold."""
    per_hour = min(config.false_alarms_per_hour * series.share, 0.5)
    samples = independent(series, per_hour)
    if samples.z.size == 0:
        return None
    fitted = fit(samples.z[: baseline_of(samples.z.size)])
    if fitted.refusal is not None:
        return Refusal(f"rule '{rule.name}' does not judge: {fitted.refusal.reason}")
    rule = replace(rule, parameters=rule.configured(rule.parameters, config))
    threshold = threshold_for(rule, per_hour, rate_hz=1.0 / samples.spacing_s)
    path = rule.run(whiten(samples.z, fitted.rho))
    first = int(first_alarm(path, threshold))
    if first == path.size:
        return None
    return _decision(rule, series, samples, path, (first, threshold, per_hour), config)


def baseline_of(samples: int) -> int:
    """How many of the first samples tell what all are like."""
    return min(max(samples // 3, LEAST_SAMPLES), BASELINE)


def independent(series: StatisticSeries, per_hour: float) -> Samples:
    """One sample of each stretch of a window, in every unbroken piece."""
    spacing_s = max(series.window_s, 1e-9)
    z = series.value / series.sigma
    tests = 1.0
    if series.threshold_sigmas is not None:
        one = 2.0 * np.exp(log_ndtr(-series.threshold_sigmas))
        tests = max(per_hour / one * spacing_s / 3600.0, 1.0)
    rows = [
        _of_stretch(np.abs(z), members, tests > 1.0)
        for piece in np.unique(series.segment)
        for members in _stretches(series, np.flatnonzero(series.segment == piece), spacing_s)
    ]
    row = np.array(rows, dtype=np.int64)
    return Samples(_worth(z[row], tests), row, spacing_s)


def _stretches(
    series: StatisticSeries, rows: NDArray[np.int64], spacing_s: float
) -> list[NDArray[np.int64]]:
    time_s = series.time_s[rows]
    # Half a millionth of a stretch: times that are whole multiples must not fall short of one.
    number = np.floor((time_s - time_s[0]) / spacing_s + 5e-7).astype(np.int64)
    return np.split(rows, np.flatnonzero(np.diff(number)) + 1)


def _of_stretch(size: NDArray[np.float64], rows: NDArray[np.int64], largest: bool) -> int:
    return int(rows[np.argmax(size[rows])] if largest else rows[0])


def _worth(z: NDArray[np.float64], tests: float) -> NDArray[np.float64]:
    """Signed deviate of the largest of so many independent two-sided tests."""
    if tests == 1.0:
        return z
    with np.errstate(divide="ignore"):
        # ln of the probability that one test, and then any of them, is so large or larger.
        log_p = np.minimum(log_ndtr(-np.abs(z)) + np.log(2.0), -1e-12)
        log_any = np.log(-np.expm1(tests * np.log1p(-np.exp(log_p))))
    log_any = np.where(np.isfinite(log_any), log_any, log_p + np.log(tests))
    return np.asarray(-np.sign(z) * ndtri_exp(np.minimum(log_any, -1e-12) - np.log(2.0)))


def _decision(
    rule: SequentialRule[Any],
    series: StatisticSeries,
    samples: Samples,
    path: NDArray[np.float64],
    alarm: tuple[int, float, float],
    config: DetectionConfig,
) -> Decision:
    first, threshold, per_hour = alarm
    row = int(samples.row[first])
    alarm_s = float(series.time_s[row])
    quiet = np.flatnonzero(path[:first] < QUIET * threshold)
    climbing = samples.row[quiet[-1] if quiet.size else 0]
    before_s = max(config.onset_lookback_s, 1.5 * MIN_BEFORE * samples.spacing_s)
    lookback_s = before_s + alarm_s - float(series.time_s[climbing])
    statistic = float(np.max(path[first : first + 2]))
    per_sample = np.log10(per_hour * samples.spacing_s / 3600.0)
    return Decision(
        alarm_s=alarm_s,
        onset_s=onset_time(series, row, lookback_s),
        statistic=statistic,
        threshold=threshold,
        log10_p=float(np.clip(per_sample + _rarer(rule, statistic, threshold), LOG10_P_FLOOR, 0.0)),
        unit=UNITS[rule.scale],
    )


def _rarer(rule: SequentialRule[Any], statistic: float, threshold: float) -> float:
    """log10 of how much rarer the statistic is than its threshold."""
    if rule.scale == "log-likelihood":
        ln = threshold - statistic
    elif rule.scale == "deviate":
        ln = float(log_ndtr(-statistic) - log_ndtr(-threshold))
    else:
        window = rule.parameters.window
        ln = float(chi2.logsf(statistic, window) - chi2.logsf(threshold, window))
    return ln / float(np.log(10.0))
