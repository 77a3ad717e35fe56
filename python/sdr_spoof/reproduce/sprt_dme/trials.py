"""Monte Carlo of rules and of the measurement model, and numbers with their standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.aiding.dme.feedback import Feedback
from sdr_spoof.aiding.dme.model import Runs, simulate
from sdr_spoof.aiding.dme.spoofing import Spoofing, step
from sdr_spoof.decision.rule import SequentialRule, first_alarm
from sdr_spoof.reproduce.parallel import seed_of
from sdr_spoof.reproduce.study import Number

from . import published

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.dme.geometry import Geometry
    from sdr_spoof.aiding.dme.statistics import Statistic

STUDY = 7001
ERRORS = 4.0
"""Standard errors by which a number may be off."""
UNPREDICTED = 900
"""Epochs after the onset that are simulated where delays are measured."""


def random_of(*case: float) -> np.random.Generator:
    """Noise of a case."""
    return np.random.default_rng(seed_of(STUDY, case, 0))


@dataclass(frozen=True)
class Delays:
    """Delays of the runs without an alarm before the onset, in s; infinite where none came."""

    values_s: NDArray[np.float64]

    @property
    def mean_s(self) -> float:
        """Of the runs that alarmed."""
        found = self.values_s[np.isfinite(self.values_s)]
        return float(found.mean()) if found.size else float("nan")

    @property
    def error_s(self) -> float:
        """Standard error of the mean."""
        found = self.values_s[np.isfinite(self.values_s)]
        return float(found.std() / max(found.size, 1) ** 0.5) if found.size else float("nan")

    def quantile_s(self, share: float) -> float:
        """Of all runs; infinite where fewer alarmed."""
        if not self.values_s.size:
            return float("nan")
        return float(np.quantile(self.values_s, share, method="inverted_cdf"))

    def within(self, limit_s: float = published.WITHIN_S) -> float:
        """Share of runs with an alarm in time."""
        return float(np.mean(self.values_s <= limit_s)) if self.values_s.size else float("nan")


def delays_of(path: NDArray[np.float64], threshold: float, onset: int) -> Delays:
    """From paths (R, N) or of several channels (R, C, N), of which the first alarm counts."""
    first = first_alarm(path, threshold)
    if first.ndim > 1:
        first = first.min(axis=1)
    late = first[first >= onset]
    since = np.where(late < path.shape[-1], late - onset + 1.0, np.inf)
    return Delays(since)


def shifted(
    shift: float, onset: int, after: int, runs: int, random: np.random.Generator
) -> NDArray[np.float64]:
    """Unit samples whose mean shifts at the onset, (R, N)."""
    z = random.standard_normal((runs, onset + after))
    z[:, onset:] += shift
    return z


def shift_delays(
    rule: SequentialRule[Any],
    threshold: float,
    shift: float,
    runs: int,
    *,
    onset: int = published.ONSET_S,
    after: int = UNPREDICTED,
) -> Delays:
    """Of a shift of unit samples, a few hundred runs at a time."""
    random = random_of(shift, onset)
    parts = []
    for first in range(0, runs, 500):
        z = shifted(shift, onset, after, min(500, runs - first), random)
        parts.append(delays_of(rule.run(z), threshold, onset).values_s)
    return Delays(np.concatenate(parts))


@dataclass(frozen=True)
class Case:
    """One scenario of the measurement model."""

    geometry: Geometry
    spoofing: Spoofing | None
    feedback: Feedback = field(default_factory=Feedback)
    after: int = published.WITHIN_S
    onset: int = published.ONSET_S

    def run(self, runs: int, random: np.random.Generator) -> Runs:
        """Simulated."""
        return simulate(
            self.geometry,
            self.onset + self.after,
            runs,
            random,
            spoofing=self.spoofing,
            feedback=self.feedback,
        )


def steps(
    sigma_m: float,
    size_m: float,
    count: int,
    feedback: Feedback | None = None,
    *,
    stations: bool = True,
    after: int = published.WITHIN_S,
) -> Case:
    """A step on the first so many satellites of the published order."""
    spoofing = step(published.ORDER[:count], size_m, published.ONSET_S)
    made = published.geometry(sigma_m, stations)
    return Case(made, spoofing, feedback or Feedback(), after)


def channels(
    statistic: Statistic, differences_m: NDArray[np.float64], geometry: Geometry
) -> NDArray[np.float64]:
    """Channels before time: (R, C, N)."""
    return np.moveaxis(statistic.values(differences_m, geometry), -1, -2)


def blocks(runs: int, size: int = 500) -> Sequence[int]:
    """Runs in parts that fit into memory."""
    return [min(size, runs - first) for first in range(0, runs, size)]


def share_number(
    name: str, what: str, hits: float, runs: int, reference: float, tolerance: float = 0.0
) -> Number:
    """A probability that must lie within a tolerance and four standard errors."""
    error = ERRORS * (max(reference * (1.0 - reference), 1.0 / runs) / runs) ** 0.5 + tolerance
    return Number(name, what, hits, reference - error, reference + error, "", reference)


def median_error(values: NDArray[np.float64]) -> float:
    """Standard error of a median, from the quartiles of about normal values."""
    low, high = np.quantile(values, (0.25, 0.75), method="inverted_cdf")
    return float(1.2533 * (high - low) / 1.349 / max(values.size, 1) ** 0.5)
