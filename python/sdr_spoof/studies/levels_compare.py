"""Whether a detector says the same at both levels: distributions, means, variances, latencies.

Rows of one track are correlated, those of different tracks (satellites, runs) are not. So means and
variances are compared between tracks: of every track the mean of its rows, and the mean square
about the common mean, whose scatter from track to track gives the standard error. Distributions go
through the two-sample Kolmogorov-Smirnov test, on rows so far apart that they share no signal: a
window and its reference. Times to the alarm are one of each track, and go through the same test.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import ks_2samp, norm, ttest_ind_from_stats

from sdr_spoof.detectors import StatisticSeries, common_cause
from sdr_spoof.fusion import share_of
from sdr_spoof.verdict import statistics

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.detectors import DetectionConfig
    from sdr_spoof.records import TrackLog

    Floats = NDArray[np.float64]

STANDARD_ERRORS = 4.0
LEAST_P = 6.3e-5
"""Two-sided probability of 4 standard errors."""
NOTHING = 1e-6
"""Deviates this far apart are equal."""
REFERENCES = {
    "phase_difference_glr": "phase_difference_glr_reference_s",
    "code_difference": "code_difference_reference_s",
    "code_minus_carrier": "code_minus_carrier_reference_s",
    "delta_metric": "quality_reference_s",
    "delta_metric_variance": "quality_reference_s",
    "ratio_metric": "quality_reference_s",
    "ratio_metric_variance": "quality_reference_s",
    "power": "power_reference_s",
    "power_difference": "power_difference_reference_s",
}
"""Setting that holds the reference of a detector; others have none."""
Name = tuple[str, str, str]
"""Detector, signal (empty where it compares two), quantity."""


@dataclass(frozen=True)
class Observed:
    """One series of one track."""

    name: Name
    mean: float
    """Of the deviates of all rows; NaN where there are none."""
    square: float
    """Mean square of them."""
    apart: Floats
    """Deviates that share no signal."""
    alarm_s: float
    """First row beyond the threshold, infinite for none."""


def observe(log: TrackLog, config: DetectionConfig, from_s: float = 0.0) -> list[Observed]:
    """Every series of a log, its deviates from a time on and its alarm.

    What all satellites share, the noise floor of a band, is taken once.
    """
    shared = set()
    found = []
    for series in statistics(log, config):
        if common_cause(series) is not None:
            if series.signal in shared:
                continue
            shared.add(series.signal)
        found.append(_observed(series, config, from_s))
    return found


def _observed(series: StatisticSeries, config: DetectionConfig, from_s: float) -> Observed:
    threshold = series.threshold(share_of(config).false_alarm_probability)
    alarms = series.time_s[np.abs(series.value) > threshold]
    kept = series.time_s >= from_s
    deviate, time_s = (series.value / series.sigma)[kept], series.time_s[kept]
    return Observed(
        name=(series.detector, series.signal or "", series.quantity),
        mean=float(deviate.mean()) if deviate.size else float("nan"),
        square=float(np.mean(deviate**2)) if deviate.size else float("nan"),
        apart=deviate[_apart(time_s, memory_s(series, config))],
        alarm_s=float(np.min(alarms, initial=np.inf)),
    )


def memory_s(series: StatisticSeries, config: DetectionConfig) -> float:
    """Signal that one row is made from: its window and its reference."""
    field = REFERENCES.get(series.detector)
    return series.window_s + (float(getattr(config, field)) if field else 0.0)


def _apart(time_s: Floats, step_s: float) -> NDArray[np.int64]:
    """Rows at least a step apart, from the last one backwards."""
    rows = []
    last_s = np.inf
    for row in range(time_s.size - 1, -1, -1):
        if last_s - time_s[row] >= step_s:
            rows.append(row)
            last_s = time_s[row]
    return np.array(rows[::-1], dtype=np.int64)


@dataclass(frozen=True)
class Pair:
    """A number at both levels, and how far apart that is."""

    seen: float
    """At IF level."""
    made: float
    """At correlator level."""
    error: float
    """Standard error of the difference."""
    deviate: float
    """Made minus seen as a normal deviate of the same probability (Welch's test: the errors are
    measured on few tracks); 0 where there is nothing to compare."""


@dataclass(frozen=True)
class Comparison:
    """One series of a detector at both levels."""

    attack: str
    cn0_dbhz: float
    name: Name
    tracks: tuple[int, int]
    """With tests, at IF and correlator level."""
    mean: Pair
    variance: Pair
    values: tuple[int, int]
    """That share no signal."""
    p: float
    """Of the Kolmogorov-Smirnov test on them; 1 where there are none."""
    latency_s: tuple[Floats, Floats]
    """From the start of the drag to the alarm, infinite for none; empty without an attack."""
    latency_p: float

    @property
    def agrees(self) -> bool:
        """Whether nothing differs by more than 4 standard errors, or as improbably."""
        deviates = abs(self.mean.deviate), abs(self.variance.deviate)
        return max(deviates) < STANDARD_ERRORS and min(self.p, self.latency_p) > LEAST_P

    def row(self) -> dict[str, Any]:
        """For the table in full."""
        detector, signal, quantity = self.name
        row: dict[str, Any] = {"attack": self.attack, "cn0_dbhz": self.cn0_dbhz}
        row |= {"detector": detector, "signal": signal, "quantity": quantity}
        for name, pair in (("mean", self.mean), ("variance", self.variance)):
            row |= {f"{name}_{key}": _short(value) for key, value in asdict(pair).items()}
        row |= {"tracks_seen": self.tracks[0], "tracks_made": self.tracks[1]}
        row |= {"values_seen": self.values[0], "values_made": self.values[1], "p": _short(self.p)}
        for name, latency_s in zip(("seen", "made"), self.latency_s, strict=True):
            row[f"alarms_{name}"] = int(np.isfinite(latency_s).sum())
            row[f"latency_{name}_s"] = _short(median(latency_s))
        return row | {"latency_p": _short(self.latency_p), "agrees": self.agrees}


def compare(
    attack: str,
    cn0_dbhz: float,
    seen: Sequence[Observed],
    made: Sequence[Observed],
    drag_s: float,
) -> list[Comparison]:
    """Every series that has been observed, at IF level (seen) and at correlator level (made)."""
    both: dict[Name, tuple[list[Observed], list[Observed]]] = {}
    for level, observed in enumerate((seen, made)):
        for o in observed:
            both.setdefault(o.name, ([], []))[level].append(o)
    return [_comparison(attack, cn0_dbhz, name, *pair, drag_s) for name, pair in both.items()]


def _comparison(
    attack: str,
    cn0_dbhz: float,
    name: Name,
    seen: list[Observed],
    made: list[Observed],
    drag_s: float,
) -> Comparison:
    tested = [[o for o in s if np.isfinite(o.mean)] for s in (seen, made)]
    centre = float(np.mean([o.mean for s in tested for o in s] or [0.0]))
    apart = [np.concatenate([np.empty(0), *(o.apart for o in s)]) for s in tested]
    latency_s = [
        np.array([o.alarm_s - drag_s for o in s if attack != "clean"]) for s in (seen, made)
    ]
    return Comparison(
        attack=attack,
        cn0_dbhz=cn0_dbhz,
        name=name,
        tracks=(len(tested[0]), len(tested[1])),
        mean=_pair(tested, lambda o: o.mean),
        variance=_pair(tested, lambda o: o.square - 2.0 * centre * o.mean + centre**2),
        values=(apart[0].size, apart[1].size),
        p=same_law(*apart),
        latency_s=(latency_s[0], latency_s[1]),
        latency_p=same_law(*latency_s),
    )


def _pair(tested: list[list[Observed]], number: Callable[[Observed], float]) -> Pair:
    """Means over tracks."""
    each = [np.array([number(o) for o in s]) for s in tested]
    seen, made = (float(x.mean()) if x.size else float("nan") for x in each)
    if min(x.size for x in each) < 2:
        return Pair(seen, made, float("nan"), 0.0)
    error = float(np.sqrt(sum(x.var(ddof=1) / x.size for x in each)))
    if error <= NOTHING:  # all the same, as rises of power are 0
        return Pair(seen, made, 0.0, 0.0)
    (a, b), (m, n) = (x.std(ddof=1) for x in each), (x.size for x in each)
    p = float(ttest_ind_from_stats(seen, a, m, made, b, n, equal_var=False).pvalue)
    return Pair(seen, made, error, float(np.sign(made - seen) * norm.isf(p / 2.0)))


def same_law(a: Floats, b: Floats) -> float:
    """Probability of two such samples of one law (Kolmogorov-Smirnov); infinite values may be."""
    if not (a.size and b.size):
        return 1.0
    return float(ks_2samp(np.minimum(a, 1e9), np.minimum(b, 1e9)).pvalue)


def median(latency_s: Floats) -> float:
    """Median of the alarms; NaN where there are none."""
    alarms = latency_s[np.isfinite(latency_s)]
    return float(np.median(alarms)) if alarms.size else float("nan")


def _short(value: float) -> float:
    return float(f"{value:.5g}")


@dataclass(frozen=True)
class Summary:
    """All series of a detector under one attack."""

    detector: str
    attack: str
    series: int
    """Signals, quantities and C/N0."""
    least_p: float
    largest_mean_deviate: float
    largest_variance_deviate: float
    least_latency_p: float
    disagree: int


def summary(found: Sequence[Comparison]) -> list[Summary]:
    """One row for each detector and attack."""
    groups = dict.fromkeys((c.name[0], c.attack) for c in found)
    return [
        _summary(*group, [c for c in found if (c.name[0], c.attack) == group]) for group in groups
    ]


def _summary(detector: str, attack: str, of: list[Comparison]) -> Summary:
    return Summary(
        detector=detector,
        attack=attack,
        series=len(of),
        least_p=_short(min(c.p for c in of)),
        largest_mean_deviate=_short(max(abs(c.mean.deviate) for c in of)),
        largest_variance_deviate=_short(max(abs(c.variance.deviate) for c in of)),
        least_latency_p=_short(min(c.latency_p for c in of)),
        disagree=sum(not c.agrees for c in of),
    )
