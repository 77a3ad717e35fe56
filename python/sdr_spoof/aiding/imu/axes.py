"""Axes of an IMU as it is mounted, by three letters, such as FRD or RFU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_DIRECTIONS = {
    "F": (1.0, 0.0, 0.0),
    "B": (-1.0, 0.0, 0.0),
    "R": (0.0, 1.0, 0.0),
    "L": (0.0, -1.0, 0.0),
    "D": (0.0, 0.0, 1.0),
    "U": (0.0, 0.0, -1.0),
}


def checked(letters: str) -> str:
    """Three letters in capitals.

    Raises:
        ValueError: they name no axes, or left-handed ones.
    """
    name = letters.upper()
    known = len(name) == 3 and set(name) <= set(_DIRECTIONS)
    size = float(np.linalg.det([_DIRECTIONS[c] for c in name])) if known else 0.0
    if size == 0.0:
        raise ValueError(
            f"axes {letters!r}: say where x, y and z point with a letter each of forward, back, "
            "right, left, up and down: FRD, FLU, RFU"
        )
    if size < 0.0:
        raise ValueError(f"axes {letters!r} are left-handed; turn one of them round")
    return name


def into_body(letters: str) -> NDArray[np.float64]:
    """Matrix (3, 3) from such axes to forward, right, down."""
    return np.array([_DIRECTIONS[c] for c in checked(letters)]).T
