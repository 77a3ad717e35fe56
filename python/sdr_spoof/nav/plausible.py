"""Ephemerides that no satellite can have."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .ephemeris import Ephemeris

DAY_S = 86_400.0
RANGES = {
    "a": (20e6, 50e6),
    "e": (0.0, 0.5),
    "i0": (-math.pi, math.pi),
    "a0": (-0.1, 0.1),
    "a1": (-1e-6, 1e-6),
    "delta_n": (-1e-6, 1e-6),
    "omega_dot": (-1e-6, 1e-6),
    "iode": (0, 1023),
    "iodc": (0, 1023),
    "health": (0, 1023),
}
"""Medium and high orbits of GPS and BDS, with room."""


def objection(e: Ephemeris) -> str | None:
    """What speaks against an ephemeris; None if nothing."""
    for name, (low, high) in RANGES.items():
        value = getattr(e, name)
        if not low <= value <= high:
            return f"{name} is {value:g}, must be from {low:g} to {high:g}"
    if abs(e.toe - e.toc) > 2 * DAY_S:
        return f"its orbit and clock are {abs(e.toe - e.toc) / 3600:.0f} h apart"
    return None
