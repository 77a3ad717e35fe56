"""Delta metric of each signal: asymmetry of its correlation peak, (E - L) / (2 P).

Physics: a reflection or a spoofer beside the peak lifts one flank. The code loop that steers by the
same two taps pulls the asymmetry out again within its time constant (a quarter of a second at
1 Hz), so that what is seen is the change; averages over longer windows scatter less than the law
says. Law, sources and laws of the mean and of the scatter: :mod:`.signal_quality`.
"""

from __future__ import annotations

from functools import partial

from sdr_spoof.detectors.signal_quality import Metric, statistics

NAME = "delta_metric"
SCATTER = "delta_metric_variance"
METRIC = Metric(NAME, "(E - L) / 2P", (0.5, -0.5), split_states=True)

mean = partial(statistics, METRIC, False, NAME)
scatter = partial(statistics, METRIC, True, SCATTER)
