"""A second signal of the same satellite, well away from the one that is tracked.

The searches are made beside tracking (:mod:`sdr_spoof.second_peaks`), on samples from which the
tracked signals have been taken out. A reflection comes later by its detour: ten chips of a code of
2 Mcps are 1.5 km, far beyond any that still has power, and nothing reflected comes earlier. Two
peaks further apart are two transmitters: a spoofer or a repeater beside the satellite. Which of the
two is tracked cannot be told.

Law under H0. The probability that noise makes a statistic as large anywhere in a search follows
from its law (:mod:`sdr_spoof.acquisition_threshold`); the value is the two-sided normal quantile of
it. The threshold is that of the search, ``second_peak_pfa``; a search looks at milliseconds each
``second_peak_every_s``, which makes no support for the verdict 'clean'.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np
import scipy

from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.records import SecondPeak, TrackLog
from sdr_spoof.signals import signal_spec

NAME = "second_peak"
CAUSE = (
    "a second signal of this satellite is on the air, from a spoofer or a repeater; "
    "which of both is true cannot be told"
)
"""What an alarm means, in words."""
SEARCH_S = 0.02
"""Signal that one search looks at, about."""


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The searches of each satellite; none where none were made."""
    del config
    by_signal: dict[tuple[str, int], list[SecondPeak]] = defaultdict(list)
    for peak in log.second_peaks:
        by_signal[peak.signal, peak.prn].append(peak)
    for (signal, prn), peaks in by_signal.items():
        yield _series(signal, prn, peaks, log.sample_rate_hz)


def _series(
    signal: str, prn: int, peaks: list[SecondPeak], sample_rate_hz: float
) -> StatisticSeries:
    time_s = np.array([p.sample_index for p in peaks]) / sample_rate_hz
    value = np.array([-float(scipy.special.ndtri(0.5 * 10.0**p.log10_p)) for p in peaks])
    return StatisticSeries(
        detector=NAME,
        system=signal_spec(signal).system,
        prn=prn,
        unit="sigma",
        time_s=time_s + SEARCH_S,
        value=value,
        sigma=np.ones(value.size),
        sigma_thermal=np.ones(value.size),
        segment=np.arange(value.size),
        window_s=SEARCH_S,
        trace_time_s=time_s,
        trace=value,
        trace_unit="sigma, largest second peak",
        trace_segment=np.arange(value.size),
        notes=(),
        signal=signal,
        threshold_sigmas=-float(scipy.special.ndtri(0.5 * peaks[0].false_alarm_probability)),
    )
