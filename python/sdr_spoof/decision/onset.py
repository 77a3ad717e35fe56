"""Onset of a disturbance: the maximum-likelihood change point of the trace before the alarm.

Two models of the disturbance, after a line before it: a kink (a drag that begins in phase), or a
new line after a jump (a capture with any phase). The noise is white and Gaussian, so the most
likely change of either model minimises its sum of squared residuals; the jump has a parameter
more and must earn it by the Bayesian information criterion. So must any change against none: where
the difference turned all along, as after a signal was found again, the disturbance is older than
the trace.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.detectors.series import StatisticSeries

MIN_BEFORE = 10
"""Fewest rows that fix the line before the change."""
MIN_AFTER = 4
"""Fewest rows after the change: two more than a line has parameters."""


def onset_time(series: StatisticSeries, row: int, lookback_s: float) -> float:
    """Most likely start of the deviation that raised the alarm at ``row``, in s.

    Searched from ``lookback_s`` before the alarm's window to the alarm, inside the alarm's
    unbroken piece of tracking; its first row where the trace shows no change, only a slope. A jump
    may raise the alarm with its first row: the few rows after it that a change needs are used too.
    """
    alarm_s = float(series.time_s[row])
    start_s = alarm_s - series.window_s - lookback_s
    same = np.flatnonzero(series.trace_segment == series.segment[row])
    first, last = np.searchsorted(series.trace_time_s[same], (start_s, alarm_s))
    inside = same[first : last + MIN_AFTER]
    time, trace = series.trace_time_s[inside], series.trace[inside]
    if time.size < MIN_BEFORE + MIN_AFTER:
        return max(alarm_s - series.window_s, 0.0)
    change = change_point(time - time[0], trace - trace[0])
    if change == 0:
        return float(time[0])
    # The change lies between the last quiet epoch and the first disturbed one.
    return float(0.5 * (time[change - 1] + time[change]))


def change_point(time_s: NDArray[np.float64], values: NDArray[np.float64]) -> int:
    """First row after the most likely change, a kink or a jump; 0 for none; O(N)."""
    candidates = np.arange(MIN_BEFORE, time_s.size - MIN_AFTER + 1)
    x = time_s / float(time_s[-1])
    before = _growing_rss(x, values, 2)
    after = _growing_rss(1.0 - x[::-1], values[::-1], 2)[::-1]
    jump = before[candidates - 1] + after[candidates]
    kink = _kink_rss(x, values, candidates)
    price = float(jump.min()) / values.size * np.log(values.size)
    best = kink if float(kink.min()) < float(jump.min()) + price else jump
    # A change has two parameters more than a line, its place and its size; the jump three.
    spent = 2 if best is kink else 3
    if float(before[-1]) < float(best.min()) + spent * price:
        return 0
    return int(candidates[np.argmin(best)])


def _kink_rss(
    x: NDArray[np.float64], y: NDArray[np.float64], candidates: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Residual sum of squares of a line that turns at the row before each candidate.

    The turn max(x - x_k, 0) is projected off the line; its products come from sums over tails.
    """
    basis, _ = np.linalg.qr(np.vander(x, 2))
    residual = y - basis @ (basis.T @ y)
    turn_at = x[candidates - 1]

    def product(weights: NDArray[np.float64]) -> NDArray[np.float64]:
        tails = [np.cumsum(w[::-1])[::-1][candidates] for w in (weights * x, weights)]
        return np.asarray(tails[0] - turn_at * tails[1])

    along = product(basis[:, 0]) ** 2 + product(basis[:, 1]) ** 2
    square = product(x) - turn_at * product(np.ones(x.size)) - along
    return np.asarray(residual @ residual - product(residual) ** 2 / square)


def _growing_rss(
    x: NDArray[np.float64], y: NDArray[np.float64], parameters: int
) -> NDArray[np.float64]:
    """Residual sum of squares of a polynomial fit to rows [0, k], for every k; shape (N,).

    Recursive least squares: each row adds its squared innovation over 1 + leverage.
    """
    covariance = np.eye(parameters) * 1e8
    solution = np.zeros(parameters)
    design = np.vander(x, parameters)
    rss = np.empty(x.size)
    total = 0.0
    for k, (row, value) in enumerate(zip(design, y, strict=True)):
        gain = covariance @ row
        spread = 1.0 + float(row @ gain)
        innovation = float(value - row @ solution)
        total += innovation**2 / spread
        solution = solution + gain * (innovation / spread)
        covariance = covariance - np.outer(gain, gain) / spread
        rss[k] = total
    return rss
