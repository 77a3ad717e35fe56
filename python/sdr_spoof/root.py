"""Root of a continuous function, for thresholds; scipy.optimize takes half a second to import."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

MOST_STEPS = 200
"""Smooth functions need about ten."""


def root(function: Callable[[float], float], low: float, high: float, within: float) -> float:
    """Where a function that changes sign between ``low`` and ``high`` is zero.

    By the Illinois method: false position that halves the value at an end which stays (Dowell and
    Jarratt, "A modified regula falsi method for computing the root of an equation", BIT 11, 1971).
    Ends when a step moves by less than ``within``.

    Raises:
        ValueError: the function has the same sign at both ends.
    """
    at_low, at_high = function(low), function(high)
    if at_low * at_high > 0.0:
        raise ValueError(f"no change of sign between {low:g} and {high:g}")
    last = low
    for _ in range(MOST_STEPS):
        middle = (low * at_high - high * at_low) / (at_high - at_low) if at_low else low
        at_middle = function(middle)
        if at_middle == 0.0 or abs(middle - last) < within:
            return middle
        if at_middle * at_high < 0.0:  # the root lies between the last two
            low, at_low = high, at_high
        else:
            at_low *= 0.5
        last = high = middle
        at_high = at_middle
    return last
