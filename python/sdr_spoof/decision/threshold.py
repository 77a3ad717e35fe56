"""Two-sided threshold with latch: the first test beyond the threshold raises the alarm for good.

The latch matters: once a coherent spoofer has captured the loop the difference is quiet again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.decision.onset import onset_time
from sdr_spoof.decision.record import Decision
from sdr_spoof.decision.rule import Change, SequentialRule
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries


@dataclass(frozen=True)
class Parameters:
    """None."""


def path(z: NDArray[np.float64], parameters: Parameters) -> NDArray[np.float64]:
    """The size of each sample; NaN for what is not a finite number."""
    del parameters
    size = np.abs(z)
    size[size == np.inf] = np.nan
    return np.asarray(size)


def decide(series: StatisticSeries, config: DetectionConfig) -> Decision | None:
    """Fires at the first |value| > threshold, or returns None."""
    threshold = series.threshold(config.false_alarm_probability)
    crossings = np.flatnonzero(np.abs(series.value) > threshold)
    if crossings.size == 0:
        return None
    first = int(crossings[0])
    held = np.flatnonzero(series.time_s <= series.time_s[first] + series.window_s)
    held = held[held >= first]
    peak = int(held[np.argmax(np.abs(series.value[held]) / series.sigma[held])])
    return Decision(
        alarm_s=float(series.time_s[first]),
        onset_s=onset_time(series, first, config.onset_lookback_s),
        statistic=float(series.value[peak]),
        threshold=float(threshold[peak]),
        log10_p=series.log10_p(peak),
    )


RULE = SequentialRule(
    "threshold",
    "Threshold",
    "whether one test is beyond what noise explains",
    path,
    Parameters(),
    lambda _: Change(template=(1.0,), sizes=(3.5, 5.0, 7.0)),
    "deviate",
    decide=decide,
)
