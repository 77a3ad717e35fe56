"""Cycle slips: jumps by a whole number of quanta within one epoch, told apart from attacks.

A Costas loop (data signal) can slip by half a cycle, a pilot's loop by whole cycles. The measured
phase (oscillator plus discriminator) then jumps by exactly that much between two epochs, while
both sides of the jump stay on parallel lines. A capture by a spoofer jumps by any amount. What
is repaired is therefore a step that (1) happens in one epoch, (2) is a multiple of the signal's
quantum within 5 standard deviations, and (3) stands alone: two or more in one test window are
left in, because thermal slips do not come in bursts at a usable C/N0, while the beat between an
authentic and a spoofed signal of similar power does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

FIT_ROWS = 20
"""Epochs on each side from which the size of a jump is measured."""
CANDIDATE = 0.6
"""Part of a quantum that a step must exceed to be looked at."""


def find_slips(
    phase_cycles: NDArray[np.float64], quantum_cycles: float, sigma_cycles: float
) -> list[tuple[int, float]]:
    """Jumps by a multiple of the quantum: (first row after the jump, size in cycles).

    ``sigma_cycles`` is the white noise of one phase. O(N) plus a small fit per candidate.
    """
    if phase_cycles.size < 4:
        return []
    steps = np.diff(phase_cycles)
    excess = np.abs(steps - median_filter(steps, size=11, mode="nearest"))
    slips = []
    for row in np.flatnonzero(excess > CANDIDATE * quantum_cycles) + 1:
        jump, jump_sigma = measure_jump(phase_cycles, int(row), sigma_cycles)
        size = round(jump / quantum_cycles) * quantum_cycles
        if size != 0.0 and abs(jump - size) < 5.0 * jump_sigma:
            slips.append((int(row), size))
    return slips


def measure_jump(
    phase_cycles: NDArray[np.float64], row: int, sigma_cycles: float
) -> tuple[float, float]:
    """Jump at ``row`` between two parallel lines, and its standard deviation, in cycles."""
    start, stop = max(row - FIT_ROWS, 0), min(row + FIT_ROWS, phase_cycles.size)
    rows = np.arange(start, stop) - row
    after = (rows >= 0).astype(np.float64)
    design = np.column_stack([np.ones(rows.size), rows, after])
    pseudo_inverse = np.linalg.pinv(design)
    jump = float(pseudo_inverse[2] @ (phase_cycles[start:stop] - phase_cycles[start]))
    return jump, sigma_cycles * float(np.linalg.norm(pseudo_inverse[2]))


def repair_slips(
    phase_cycles: NDArray[np.float64],
    quantum_cycles: float,
    sigma_cycles: float,
    window_rows: int,
) -> tuple[NDArray[np.float64], int]:
    """Takes slips that stand alone within a window out of the phase; also returns their number."""
    slips = find_slips(phase_cycles, quantum_cycles, sigma_cycles)
    at = np.array([row for row, _ in slips])
    repaired = phase_cycles.copy()
    count = 0
    for row, size in slips:
        if np.count_nonzero(np.abs(at - row) < window_rows) == 1:
            repaired[row:] -= size
            count += 1
    return repaired, count
