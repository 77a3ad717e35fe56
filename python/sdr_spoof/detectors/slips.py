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
import scipy
from numpy.typing import NDArray

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
    excess = np.abs(steps - scipy.ndimage.median_filter(steps, size=11, mode="nearest"))
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


def repair_every_slip(
    phase_cycles: NDArray[np.float64], quantum_cycles: float, sigma_cycles: float
) -> tuple[NDArray[np.float64], int]:
    """Takes all slips out, also those in bursts; also returns the number of places.

    A loop that slips at a low C/N0 lingers half-way, where its discriminator hops to and fro:
    steps within ``FIT_ROWS`` are one slip. It is taken out if that leaves the phase nearer to a
    line (rare noise looks like two hops) and without a jump, within 5 standard deviations: a slip
    stays a multiple of the quantum, an attack's jump or course does not. The beat of an attack
    loses its flips, but goes on turning.
    """
    repaired = phase_cycles.copy()
    if phase_cycles.size < 4:
        return repaired, 0
    steps = np.diff(phase_cycles)
    excess = steps - scipy.ndimage.median_filter(steps, size=11, mode="nearest")
    quanta = np.round(excess / quantum_cycles)
    rows = np.flatnonzero(quanta) + 1
    count = 0
    for group in np.split(rows, np.flatnonzero(np.diff(rows) > FIT_ROWS) + 1):
        if group.size == 0:
            continue
        for reach in (FIT_ROWS, 2 * FIT_ROWS):
            start = max(int(group[0]) - reach, 0)
            stop = min(int(group[-1]) + reach, phase_cycles.size)
            inside = (int(group[0]) - start, int(group[-1]) - start)
            slip = _slip(
                repaired[start:stop], quanta[start : stop - 1], inside, quantum_cycles, sigma_cycles
            )
            if slip is not None:
                repaired[start:stop] -= slip
                repaired[stop:] -= slip[-1]
                count += 1
                break
    return repaired, count


def _slip(
    phase_cycles: NDArray[np.float64],
    quanta: NDArray[np.float64],
    inside: tuple[int, int],
    quantum_cycles: float,
    sigma_cycles: float,
) -> NDArray[np.float64] | None:
    """What must be taken off each row, by its hops or by lines; None if it is no slip."""
    inner = np.zeros(phase_cycles.size)
    inner[inside[0] : inside[1] + 1] = quanta[inside[0] - 1 : inside[1]]
    for slip in (
        np.cumsum(inner) * quantum_cycles,
        _by_lines(phase_cycles, inside, quantum_cycles),
    ):
        if _is_slip(phase_cycles, slip, inside, quantum_cycles, sigma_cycles):
            return np.asarray(slip)
    return None


def _is_slip(
    phase_cycles: NDArray[np.float64],
    slip: NDArray[np.float64],
    inside: tuple[int, int],
    quantum_cycles: float,
    sigma_cycles: float,
) -> bool:
    """Whether the phase without it is straighter and goes on where it was."""
    tried = phase_cycles - slip
    (left, _), left_sigma = _parallel(tried, inside, sigma_cycles)
    straighter = _about_line(tried) < _about_line(phase_cycles)
    return bool(straighter and abs(left) < min(5.0 * left_sigma, 0.5 * quantum_cycles))


def _by_lines(
    phase_cycles: NDArray[np.float64], inside: tuple[int, int], quantum_cycles: float
) -> NDArray[np.float64]:
    """Quanta that bring every row nearest to one line, from the lines before and behind.

    Where noise itself reaches half a quantum a step (below 27 dB-Hz on data), hops are miscounted.
    """
    (jump, line), _ = _parallel(phase_cycles, inside, 0.0)
    slip = np.round((phase_cycles - line) / quantum_cycles) * quantum_cycles
    slip[: inside[0]] = 0.0
    slip[inside[1] :] = np.round(jump / quantum_cycles) * quantum_cycles
    return np.asarray(slip)


def _parallel(
    phase_cycles: NDArray[np.float64], inside: tuple[int, int], sigma_cycles: float
) -> tuple[tuple[float, NDArray[np.float64]], float]:
    """Parallel lines up to the first row inside and from the last on.

    Returns the jump between them with the line before, at every row, and the jump's sigma.
    """
    first, last = inside
    rows = np.arange(phase_cycles.size)
    outside = (rows < first) | (rows >= last)
    design = np.column_stack([np.ones(rows.size), rows, rows >= last])
    pseudo_inverse = np.linalg.pinv(design[outside])
    fitted = pseudo_inverse @ (phase_cycles - phase_cycles[0])[outside]
    line = phase_cycles[0] + design[:, :2] @ fitted[:2]
    return (float(fitted[2]), line), sigma_cycles * float(np.linalg.norm(pseudo_inverse[2]))


def _about_line(phase_cycles: NDArray[np.float64]) -> float:
    """Sum of squares about the best line."""
    line, _ = np.linalg.qr(np.vander(np.arange(phase_cycles.size, dtype=np.float64), 2))
    centred = phase_cycles - phase_cycles[0]
    return float(centred @ centred - np.sum((centred @ line) ** 2))
