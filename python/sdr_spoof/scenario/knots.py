"""Piecewise-linear profiles, as the core's emitters take them: lists of (time in s, value).

Constant before the first and after the last knot; two knots at the same time make a step.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from itertools import pairwise

Knots = list[tuple[float, float]]

STEP_S = 0.02
"""Knot spacing where a rate grows; the integral is off by (growth of the rate) step^2 / 8."""
_FAR_S = 1e6
"""Beyond any recording."""


def integral(knots: Knots, start_s: float, end_s: float) -> float:
    """Integral of a profile from one time to a later one."""
    times = [start_s, *(t for t, _ in knots if start_s < t < end_s), end_s]
    areas = ((b - a) * _value(knots, 0.5 * (a + b)) for a, b in pairwise(times))
    return sum(areas)


def integrated(rate: Knots, start: float = 0.0) -> Knots:
    """The profile whose rate of change is ``rate`` from its first knot on, for ever.

    Args:
        rate: the rate; with no knots, the result is constant.
        start: value up to the first knot.
    """
    knots = [(rate[0][0], start)] if rate else [(0.0, start)]
    last = (rate[-1][0] + _FAR_S, rate[-1][1]) if rate else (0.0, 0.0)
    for (t0, v0), (t1, v1) in pairwise([*rate, last]):
        steps = 1 if v0 == v1 else max(1, round((t1 - t0) / STEP_S))
        for k in range(1, steps + 1 if t1 > t0 else 1):
            into = (t1 - t0) * k / steps
            mean = v0 + 0.5 * (v1 - v0) * k / steps
            knots.append((t0 + into, start + mean * into))
        start = knots[-1][1]
    return knots


def _value(knots: Knots, time_s: float) -> float:
    """Value between two knots, not at one."""
    before = [k for k in knots if k[0] <= time_s]
    after = [k for k in knots if k[0] > time_s]
    if not before or not after:
        return (before[-1:] or after[:1] or [(0.0, 0.0)])[0][1]
    (t0, v0), (t1, v1) = before[-1], after[0]
    return v0 + (v1 - v0) * (time_s - t0) / (t1 - t0)


def added(a: Knots, b: Knots) -> Knots:
    """The sum of two profiles, steps included."""
    if not a or not b:
        return list(a or b)
    sides_a, sides_b = _Sides(a), _Sides(b)
    knots: Knots = []
    for t in sorted({*sides_a.times, *sides_b.times}):
        before, after = (va + vb for va, vb in zip(sides_a.at(t), sides_b.at(t), strict=True))
        knots += [(t, before)] if before == after else [(t, before), (t, after)]
    return knots


class _Sides:
    """Values of a profile just before and just after a time."""

    def __init__(self, knots: Knots) -> None:
        self.knots = knots
        self.times = [t for t, _ in knots]

    def at(self, time_s: float) -> tuple[float, float]:
        first, after = bisect_left(self.times, time_s), bisect_right(self.times, time_s)
        if after > first:
            return self.knots[first][1], self.knots[after - 1][1]
        if first in (0, len(self.knots)):
            value = self.knots[min(first, len(self.knots) - 1)][1]
            return value, value
        (t0, v0), (t1, v1) = self.knots[first - 1], self.knots[first]
        value = v0 + (v1 - v0) * (time_s - t0) / (t1 - t0)
        return value, value
