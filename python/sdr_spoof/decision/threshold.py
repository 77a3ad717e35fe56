"""Two-sided threshold with latch: the first test beyond the threshold raises the alarm for good.

The latch matters: once a coherent spoofer has captured the loop the difference is quiet again.
"""

from __future__ import annotations

import numpy as np

from sdr_spoof.decision.onset import onset_time
from sdr_spoof.decision.record import Decision
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries


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
