"""Breaks of an array's phase differences: cycle slips of one antenna against another.

Between two epochs a difference changes by the vehicle's turn, which the INS knows, by at most a
few hundredths of a cycle of motion of the source, and by noise. What remains beyond half of a
half cycle is a slip; the differences begin anew there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.sky.trajectory import rotations

from .geometry import AntennaArray

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

LEAST_CYCLES = 0.25
"""Half of the least slip, half a cycle of a signal with data."""


def pieces(
    array: AntennaArray,
    difference_cycles: Floats,
    attitude_rad: Floats,
    expected: Floats,
    wavelength_m: float,
    least_cycles: float = LEAST_CYCLES,
) -> NDArray[np.int64]:
    """Number of the unbroken piece that each epoch lies in, (E,); -1 where a phase is missing.

    Args:
        array: the antennas.
        difference_cycles: (E, A - 1), NaN where there is none.
        attitude_rad: yaw, pitch, roll, (E, 3).
        expected: directions north, east, down, (E, 3): about right is enough between two epochs.
        wavelength_m: of the carrier.
        least_cycles: a step beyond is a slip.
    """
    body = np.einsum("eij,ei->ej", rotations(attitude_rad), expected)
    left = difference_cycles + body @ array.baselines_m.T / wavelength_m
    present = np.isfinite(left).all(axis=1)
    rows = np.flatnonzero(present)
    step = np.abs(np.diff(left[rows], axis=0)).max(axis=1, initial=0.0)
    gap = np.diff(rows) > 1
    number = np.full(len(left), -1, np.int64)
    number[rows] = np.concatenate([[0], np.cumsum((step > least_cycles) | gap)])[: rows.size]
    return number
