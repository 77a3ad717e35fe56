"""Ratio metric of each signal: flatness of its correlation peak, (E + L) / (2 P).

Physics: a second peak near the first widens or narrows the sum of both. The code loop leaves this
sum alone, to first order. Sources and laws of the mean and of the scatter: :mod:`.signal_quality`.
"""

from __future__ import annotations

from functools import partial

from sdr_spoof.detectors.signal_quality import Metric, statistics

NAME = "ratio_metric"
SCATTER = "ratio_metric_variance"
METRIC = Metric(NAME, "(E + L) / 2P", (0.5, 0.5), split_states=False)

mean = partial(statistics, METRIC, False, NAME)
scatter = partial(statistics, METRIC, True, SCATTER)
