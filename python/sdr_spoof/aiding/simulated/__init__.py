"""Measurements without a receiver: true geometry, a clock, noise, and attacks on the measurements.

:func:`simulate` gives what a receiver would hand to a filter or a test, for many runs at once.
"""

from .attacks import (
    Attack,
    accelerated_drag,
    clock_drag,
    clock_step,
    false_trajectory,
    hover,
    position_step,
    range_pull,
    velocity_drag,
)
from .clock import ClockWalk
from .model import Simulated, simulate
from .noise import ReceiverNoise
from .satellites import Constellation, fixed, of_sky

__all__ = [
    "Attack",
    "ClockWalk",
    "Constellation",
    "ReceiverNoise",
    "Simulated",
    "accelerated_drag",
    "clock_drag",
    "clock_step",
    "false_trajectory",
    "fixed",
    "hover",
    "of_sky",
    "position_step",
    "range_pull",
    "simulate",
    "velocity_drag",
]
