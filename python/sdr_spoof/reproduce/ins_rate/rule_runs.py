"""The same flights and drags through every rule that judges rates: the statistic of each epoch.

A rule of the registry takes the rate of one epoch, GNSS minus INS, in east, north and up, over its
noise; or, where the drift of the INS would break it, that rate minus a line through the minute
before. The largest of the three directions counts. ``rate_consistency``, ``rate_local`` (their laws
hold the errors of the INS) and ``rate_drag`` are computed as the detectors do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import chi2, norm

from sdr_spoof import decision
from sdr_spoof.aiding.detectors import growth, local_mean, rate_drag

from . import published
from .drag_runs import (
    BASELINE,
    MEAN,
    Case,
    Flown,
    flown,
    local_with_covariance,
    noise_m_s,
    rates,
    searched,
    steps_of,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.decision import SequentialRule

    Floats = NDArray[np.float64]

FIRST_S, LAST_S, WINDOW_S = 300, 1740, 10
"""Clean seconds that are tested, in windows: all rules are trained by then."""
STATED = 0.01
"""Clean windows that may hold an alarm: 3.6 false alarms an hour."""
PATIENCE_S = 60
"""What is not found by then is missed."""


EPOCH, LINE = "rate of one epoch", "rate minus the line before"
RATE = "rate_consistency, samples one"


@dataclass(frozen=True)
class Rule:
    """A row of the comparison."""

    name: str
    on: str
    """What it is applied to."""
    law: str
    """What its threshold for a stated rate of false alarms is made for."""
    path: Callable[[Flown, Floats], Floats]
    """Of GNSS minus INS positions (K, R, M, 3) the statistic, (K, R, M), NaN where none."""
    stated: float | None = None
    """That threshold where it is in closed form; None: that of noise alone, by simulation."""


@dataclass(frozen=True)
class Judged:
    """One rule on one flight, K INS."""

    noise: Floats
    """Largest statistic of each window of noise alone, (K, W); empty without such a law."""
    clean: Floats
    """Of the clean flight, (K, W)."""
    after: Floats
    """Statistic from the onset on, (K, R, :data:`PATIENCE_S` + 1), NaN where none."""


def differenced(z: Floats) -> Floats:
    """Each epoch minus a line through those before, over what the noise makes of that."""
    values = local_mean.statistic(z, 1, BASELINE)
    return np.asarray(values / np.sqrt(local_mean.variance_factor(1, BASELINE)))


def _direct(rule: SequentialRule[Any]) -> Callable[[Flown, Floats], Floats]:
    return lambda of, position: _largest(rule.run(rates(of, position)))


def _local(rule: SequentialRule[Any]) -> Callable[[Flown, Floats], Floats]:
    return lambda of, position: _largest(rule.run(differenced(rates(of, position))))


def _largest(path: Floats) -> Floats:
    return np.asarray(path.max(axis=2))


def with_covariance(of: Flown, position: Floats) -> Floats:
    """One epoch, the covariance of the INS in its law: ``rate_consistency`` of one sample."""
    steps = steps_of(of)
    moved = growth.displacement_covariances(steps, growth.covariances(steps))
    carried = np.einsum("mij,kmjl,mil->kim", of.axes, moved, of.axes)
    sigma = np.sqrt(noise_m_s()[:, None] ** 2 + carried) / noise_m_s()[:, None]
    return _largest(np.abs(rates(of, position)) / sigma[:, None])


def _trained() -> SequentialRule[Any]:
    return decision.find("trained-threshold").with_(training=round(published.TRAINED_S))


def rules() -> Iterator[Rule]:
    """All of them."""
    find, noise = decision.find, "noise"
    yield Rule("trained-threshold", EPOCH, noise, _direct(_trained()))
    yield Rule("trained-threshold", LINE, noise, _local(_trained()))
    yield Rule("t-test", EPOCH, noise, _direct(find("t-test").with_(window=MEAN)))
    local = find("local-mean").with_(window=MEAN, baseline=BASELINE)
    yield Rule("local-mean", EPOCH, noise, _direct(local))
    for name in ("cusum", "glr-windows"):
        yield Rule(name, EPOCH, noise, _direct(find(name)))
        yield Rule(name, LINE, noise, _local(find(name)))
    ins = "noise and INS"
    one = float(norm.isf(STATED / WINDOW_S / 3 / 2))
    yield Rule("one sample", RATE, ins, with_covariance, one)
    yield Rule("local mean", "rate_local", ins, local_with_covariance, one)
    onset = float(chi2.isf(STATED / WINDOW_S / rate_drag.INDEPENDENT, 3))
    yield Rule("likelihood ratio", "rate_drag", ins, searched, onset)


def judge(case: Case, seed: int) -> list[Judged]:
    """Every rule on one flight."""
    of = flown(case, seed)
    return [_judged(rule, of) for rule in rules()]


def _judged(rule: Rule, of: Flown) -> Judged:
    noise = windows(rule.path(of, of.noise_m)) if rule.stated is None else np.empty((0, 0))
    return Judged(
        noise, windows(rule.path(of, of.clean_m)), _after(rule.path(of, of.attacked_m), of.onset)
    )


def windows(path: Floats) -> Floats:
    """Largest of each window of :data:`WINDOW_S`, all runs of an INS together: (K, W)."""
    tested = np.nan_to_num(path[..., FIRST_S:LAST_S])
    return np.asarray(tested.reshape(len(path), -1, WINDOW_S).max(axis=-1))


def _after(path: Floats, onset: NDArray[np.int64]) -> Floats:
    """The statistic at each onset, the last clean epoch, and after it, (K, R, PATIENCE_S + 1)."""
    row = onset.reshape(len(path), -1)[..., None] + np.arange(PATIENCE_S + 1)
    padded = np.pad(path, ((0, 0), (0, 0), (0, PATIENCE_S)), constant_values=np.nan)
    return np.asarray(np.take_along_axis(padded, row, axis=2))


def delay_s(after: Floats, threshold: float | Floats) -> Floats:
    """From onset to alarm, (K, R); infinite if missed, or if the alarm was there before."""
    above = np.nan_to_num(after) > np.reshape(threshold, (-1, 1, 1))
    found = above.any(axis=-1) & ~above[..., 0]
    return np.where(found, above.argmax(axis=-1), np.inf)
