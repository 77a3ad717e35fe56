"""Tightly coupled GNSS/INS: the INS judges the satellites that correct it, and leaves out liars."""

from .config import TightConfig, as_published
from .navigate import run, run_many
from .solution import STATES, TESTS, Event, Smoothed, Start, TightSolution

__all__ = [
    "STATES",
    "TESTS",
    "Event",
    "Smoothed",
    "Start",
    "TightConfig",
    "TightSolution",
    "as_published",
    "run",
    "run_many",
]
