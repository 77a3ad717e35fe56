"""Thresholds for a wanted probability of a false alarm per hour, and what a threshold achieves.

*White normal samples*: importance sampling. Runs are drawn with one of the changes that the rule
looks for (:class:`.rule.Change`) at a random onset, so that nearly all alarm, and each alarm counts
by the likelihood of its samples without a change over that of the whole mixture of changes
(D. Siegmund, *Sequential Analysis*, 1985; the sum over onsets is the Shiryaev-Roberts recursion).
Unbiased, and as exact at 1e-9 an hour as at 1e-2.

*Any other law*: plain simulation, for as many hours as give enough alarms.

A rule that forgets is simulated for :data:`LONGEST` samples, and the hour is so many times as long
(or a part of it): P = 1 - (1 - p)^n. One that does not is simulated for the whole hour.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import oaconvolve
from scipy.stats import norm

from sdr_spoof import _core
from sdr_spoof.decision import threshold_cache
from sdr_spoof.decision.laws import NORMAL, Law
from sdr_spoof.decision.rule import Change, SequentialRule
from sdr_spoof.errors import ConfigError

LONGEST = 3600
"""Samples of a run, for a rule that forgets."""
RUNS = 4000
"""Runs of importance sampling."""
MOST_ERROR = 0.25
"""Relative standard error of a probability from which on it has no threshold."""
BLOCK = 2_000_000
"""Samples that are simulated at a time."""
PLAIN_SAMPLES = 200_000_000
"""Most samples of a plain simulation."""
ALARMS = 400
"""Alarms that a plain simulation should see."""
SEED = 20261122
GRID = np.geomspace(0.5, 1e4, 800)
"""Thresholds at which probabilities are estimated; between them their logarithm is a line."""
LOG10_P = -np.concatenate([[0.02, 0.1, 0.25], np.arange(0.5, 12.1, 0.5)])
"""Probabilities within a run whose thresholds are kept."""


@dataclass(frozen=True)
class Achieved:
    """Probability of a false alarm per hour that a threshold achieves."""

    probability: float
    low: float
    """95 % interval."""
    high: float
    runs: int
    method: str


@dataclass(frozen=True)
class _Plan:
    """How an hour is simulated."""

    rows: int
    per_hour: float
    """Runs that make an hour."""

    @classmethod
    def of(cls, rule: SequentialRule[Any], rate_hz: float) -> _Plan:
        hour = max(round(3600.0 * rate_hz), 1)
        rows = LONGEST if rule.forgets else hour
        return cls(rows, hour / rows)

    def of_run(self, per_hour: float) -> float:
        """Probability within a run for one within an hour."""
        return float(-np.expm1(np.log1p(-per_hour) / self.per_hour))

    def of_hour(self, per_run: float) -> float:
        """And back; 1 where a probability was estimated above it."""
        return float(-np.expm1(np.log1p(-min(per_run, 1.0 - 1e-12)) * self.per_hour))


def threshold_for(
    rule: SequentialRule[Any], per_hour: float, *, rate_hz: float = 1.0, law: Law = NORMAL
) -> float:
    """Threshold at which noise alone raises an alarm within an hour with a given probability.

    Deterministic. Thresholds of all probabilities are simulated at once, and kept in the user's
    cache folder; those of all rules with their default parameters come along.

    Raises:
        ConfigError: no such probability or rate, or one that simulation cannot reach.
    """
    if not (0.0 < per_hour < 1.0 and rate_hz > 0.0):
        raise ConfigError(
            f"cannot calibrate for a false-alarm probability of {per_hour:g} per hour at "
            f"{rate_hz:g} Hz: the first must lie between 0 and 1, the second above 0"
        )
    plan = _Plan.of(rule, rate_hz)
    wanted = plan.of_run(per_hour)
    if law != NORMAL:
        key = f"{key_of(rule, plan.rows)} {law} {wanted:.9g}"
        return threshold_cache.remembered(
            key, lambda: [_plain_threshold(rule, plan.rows, wanted, law)]
        )[0]
    thresholds = threshold_cache.remembered(
        key_of(rule, plan.rows), lambda: simulated(rule, plan.rows)
    )
    found = float(np.interp(-np.log10(wanted), -LOG10_P, thresholds, left=np.nan, right=np.nan))
    if not np.isfinite(found):
        raise ConfigError(
            f"rule '{rule.name}' has no threshold for {per_hour:g} false alarms per hour at "
            f"{rate_hz:g} Hz, which is {wanted:.2g} in {plan.rows} samples; ask for one between "
            f"{10.0 ** LOG10_P[-1]:.0e} and {10.0 ** LOG10_P[0]:.2g} in them"
        )
    return found


def key_of(rule: SequentialRule[Any], rows: int) -> str:
    """What thresholds depend on."""
    return f"{rule.name} {rule.parameters} {rows}"


def achieved(
    rule: SequentialRule[Any],
    threshold: float,
    *,
    rate_hz: float = 1.0,
    law: Law = NORMAL,
    runs: int | None = None,
    seed: int = SEED + 1,
) -> Achieved:
    """Probability of a false alarm per hour at a threshold, with its interval.

    The draws are others than those that set thresholds.
    """
    plan = _Plan.of(rule, rate_hz)
    if law == NORMAL:
        runs = runs or _runs(plan.rows)
        found = _weighed(rule, plan.rows, runs, seed, np.array([threshold]))
        mean, error = float(found.mean[0]), float(found.error[0])
        method = "importance sampling"
    else:
        runs = runs or max(PLAIN_SAMPLES // plan.rows // 10, 1)
        mean = float(np.mean(_maxima(rule, plan.rows, runs, law, seed) > threshold))
        # Even without an alarm the probability may be three in so many runs.
        error = float(np.sqrt(max(mean * (1.0 - mean), 3.0 / 1.96 / runs) / runs))
        method = "plain simulation"
    value, low, high = (plan.of_hour(max(mean + k * error, 0.0)) for k in (0.0, -1.96, 1.96))
    return Achieved(value, low, high, runs, method)


def curve(
    rule: SequentialRule[Any],
    thresholds: NDArray[np.float64],
    *,
    rate_hz: float = 1.0,
    runs: int | None = None,
) -> NDArray[np.float64]:
    """Probability of a false alarm per hour at ascending thresholds, (G,), white normal samples."""
    plan = _Plan.of(rule, rate_hz)
    found = _weighed(rule, plan.rows, runs or _runs(plan.rows), SEED + 1, thresholds).mean
    return np.array([plan.of_hour(float(p)) for p in found])


def simulated(rule: SequentialRule[Any], rows: int = LONGEST) -> list[float]:
    """Thresholds for the probabilities :data:`LOG10_P` within so many samples; NaN for none."""
    found = _weighed(rule, rows, _runs(rows), SEED, GRID)
    # Common draws leave small steps the wrong way where few runs decide.
    falling = np.minimum.accumulate(found.mean)
    with np.errstate(divide="ignore"):
        log10_p = np.log10(falling)
    usable = np.isfinite(log10_p) & (log10_p < -1e-3) & (found.error < MOST_ERROR * found.mean)
    if np.count_nonzero(usable) < 2:
        return [float("nan")] * LOG10_P.size
    x, y = -log10_p[usable], GRID[usable]
    return [float(v) for v in np.interp(-LOG10_P, x, y, left=np.nan, right=np.nan)]


def _runs(rows: int) -> int:
    """As many runs as fit into twenty blocks."""
    return int(np.clip(20 * BLOCK // rows, 200, RUNS))


def _plain_threshold(rule: SequentialRule[Any], rows: int, wanted: float, law: Law) -> float:
    runs = int(np.ceil(ALARMS / wanted))
    if runs * rows > PLAIN_SAMPLES:
        raise ConfigError(
            f"rule '{rule.name}' cannot be calibrated for so rare a false alarm under the law "
            f"'{law.name}', which is simulated plainly: ask for at least "
            f"{ALARMS * rows / PLAIN_SAMPLES:.2g} in {rows} samples"
        )
    return float(np.quantile(_maxima(rule, rows, runs, law, SEED), 1.0 - wanted))


def _maxima(
    rule: SequentialRule[Any], rows: int, runs: int, law: Law, seed: int
) -> NDArray[np.float64]:
    """Largest statistic of each run without a change, shape (runs,)."""
    parts = [
        np.nanmax(rule.run(law.draw(rng, (count, rows))), axis=1)
        for rng, count in _blocks(rows, runs, seed)
    ]
    return np.concatenate(parts)


def _blocks(rows: int, runs: int, seed: int) -> Iterator[tuple[np.random.Generator, int]]:
    at_a_time = max(BLOCK // rows, 1)
    for number, first in enumerate(range(0, runs, at_a_time)):
        yield np.random.default_rng((seed, number)), min(at_a_time, runs - first)


@dataclass(frozen=True)
class _Weighed:
    """Probability of an alarm within a run, at each threshold of a grid, (G,)."""

    mean: NDArray[np.float64]
    error: NDArray[np.float64]


def _weighed(
    rule: SequentialRule[Any], rows: int, runs: int, seed: int, grid: NDArray[np.float64]
) -> _Weighed:
    """By importance sampling: runs drawn with a change, and what their alarms count without."""
    change = rule.change(rule.parameters)
    drawn = _templated if change.template else _changed
    total, square = np.zeros(grid.size), np.zeros(grid.size)
    for rng, count in _blocks(rows, runs, seed):
        z, ratio = drawn(change, rng, count, rows)
        top = np.maximum.accumulate(np.nan_to_num(rule.run(z), nan=-np.inf), axis=1)
        for levels, ln_ratio in zip(top, ratio, strict=True):
            first = np.searchsorted(levels, grid, side="right")
            at = np.minimum(first, rows - 1)
            weight = np.where(first < rows, np.exp(-ln_ratio[at]), 0.0)
            total += weight
            square += weight**2
    mean = total / runs
    return _Weighed(mean, np.sqrt(np.maximum(square / runs - mean**2, 0.0) / runs))


def _changed(
    change: Change, rng: np.random.Generator, runs: int, rows: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Samples with one of the changes each, and ln of their likelihood ratio up to each."""
    z = rng.standard_normal((runs, rows))
    kinds = 2 * len(change.shifts)
    # Energy is as likely as all shifts together.
    kind = rng.integers(kinds + change.energy * max(kinds, 1), size=runs)
    onset = np.zeros(runs, np.int64) if change.from_start else rng.integers(rows, size=runs)
    both = [s for d in change.shifts for s in (d, -d)]
    for run in range(runs):
        after = z[run, onset[run] :]
        if kind[run] < kinds:
            after *= change.scale
            after += both[kind[run]]
        else:
            # The density z^2 phi(z): a chi variable of three degrees of freedom with either sign.
            more = rng.standard_normal((2, after.size))
            after[:] = np.copysign(np.sqrt(after**2 + (more**2).sum(0)), after)
    pairs = [(shift, change.scale) for shift in change.shifts]
    return z, _core.change_log_ratio(z, pairs, change.energy, change.from_start)


def _templated(
    change: Change, rng: np.random.Generator, runs: int, rows: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Samples with the template added somewhere, and ln of the likelihood ratio of the whole run.

    The ratio of one place is exp(+-a y - a^2 / 2), y the statistic there (Shi, Siegmund and Yakir,
    Importance sampling for estimating p values in linkage analysis, 2007).
    """
    template = np.array(change.template)
    places = rows - template.size + 1
    z = rng.standard_normal((runs, rows))
    size = rng.choice(np.array(change.sizes), runs) * rng.choice([-1.0, 1.0], runs)
    for row, place, scale in zip(z, rng.integers(places, size=runs), size, strict=True):
        row[place : place + template.size] += scale * template
    y = oaconvolve(z, template[None, ::-1], mode="valid", axes=1)
    parts = [np.exp(-0.5 * a**2) * np.cosh(a * y).mean(1) for a in change.sizes]
    ratio = np.log(np.mean(parts, axis=0))
    return z, np.broadcast_to(ratio[:, None], z.shape)


@lru_cache(maxsize=64)
def independent_threshold(per_hour: float, rate_hz: float) -> float:
    """Two-sided normal threshold for independent tests, in closed form."""
    per_test = -np.expm1(np.log1p(-per_hour) / (3600.0 * rate_hz))
    return float(norm.isf(per_test / 2.0))
