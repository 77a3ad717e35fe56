"""Code measurements in blocks: what the tests of code delays have in common.

The measured code phase is oscillator plus discriminator, so a change of delay shows at once and
most of its noise is white; what the code loop still leaves of its own (a discriminator's slope is
that of an unfiltered code) is short against a block. The tests work on means of blocks, and measure
their noise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.jump_slope import Plan, Rows
from sdr_spoof.detectors.phase_difference import ratio_hz

BLOCK_S = 0.2
"""Longer than what the loops correlate, shorter than any window."""
SETTLE_S = 2.0
"""Left out after each (re)lock, if the configuration does not ask for more: six times the time
constant 1 / (4 B) of a code loop of B = 1 Hz and more."""
LEAST_REFERENCE_S = 5.0
"""Reference without which nothing is tested."""
GROUP_S = 1.0
"""Signal in which the noise of the blocks is measured about a line of its own."""


def epochs_per_block(epoch_s: float) -> int:
    """Whole epochs in a block."""
    return max(round(BLOCK_S / epoch_s), 1)


def plan_for(
    epoch_s: float,
    windows_s: tuple[float, ...],
    reference_s: float,
    drift_m_s: float,
    config: DetectionConfig,
) -> Plan:
    """Windows, reference and groups in blocks."""
    step_s = epochs_per_block(epoch_s) * epoch_s
    reference = (LEAST_REFERENCE_S, reference_s)
    return Plan.of(step_s, windows_s, reference, GROUP_S, drift_m_s, config.code_wander_m)


def settle_rows(epoch_s: float, config: DetectionConfig) -> int:
    """Epochs to be left out after each (re)lock."""
    return round(max(config.settle_s, SETTLE_S) / epoch_s)


def lead_s(windows_s: tuple[float, ...], reference_s: float, config: DetectionConfig) -> float:
    """How far a section must reach back over the seam."""
    return max(config.settle_s, SETTLE_S) + reference_s + max(windows_s) + GROUP_S + BLOCK_S


def code_variance(cn0_dbhz: NDArray[np.float64], epoch_s: float) -> NDArray[np.float64]:
    """Variance of early minus late dot prompt, up to a factor: (1 / c) (1 + 1 / (c T)).

    Kaplan and Hegarty, *Understanding GPS*, equation 5.8; relative to its own median.
    """
    inverse = 1.0 / ratio_hz(cn0_dbhz)
    variance = inverse * (1.0 + inverse / epoch_s)
    return np.asarray(variance / np.median(variance)) if variance.size else variance


def blocks(
    time_s: NDArray[np.float64],
    metres: NDArray[np.float64],
    spread: NDArray[np.float64],
    strong: NDArray[np.bool_],
    pieces: tuple[slice, ...],
    epoch_s: float,
    first: int,
) -> Rows:
    """Means over whole blocks within the pieces; ``first`` as in :func:`jump_slope.deviates`.

    Blocks begin at multiples of their length of the whole track's epochs. A block is strong if all
    its epochs are.
    """
    length = epochs_per_block(epoch_s)
    skip = -first % length
    count = max(time_s.size - skip, 0) // length

    def table(values: NDArray[np.generic]) -> NDArray[np.generic]:
        return values[skip : skip + count * length].reshape(count, length)

    whole = (
        slice(-(-(piece.start - skip) // length), (piece.stop - skip) // length) for piece in pieces
    )
    kept = tuple(slice(max(s.start, 0), s.stop) for s in whole if s.stop - max(s.start, 0) >= 2)
    values = np.full(count, np.nan)
    for piece in kept:
        values[piece] = table(metres)[piece].mean(axis=1)
    middle_s = table(time_s).mean(axis=1)
    return Rows(
        end_s=middle_s + 0.5 * length * epoch_s,
        middle_s=middle_s,
        values=values,
        spread=table(spread).mean(axis=1),
        strong=np.asarray(table(strong).all(axis=1), dtype=np.bool_),
        pieces=kept,
        first=(first + skip) // length,
    )


def lead_blocks(lead: int, epoch_s: float, first: int) -> int:
    """Blocks that lie within the first ``lead`` epochs of a section."""
    length = epochs_per_block(epoch_s)
    return max(lead - -first % length, 0) // length


def notes(rows: Rows, plan: Plan) -> tuple[str, ...]:
    """In words: why nothing was tested."""
    longest = max((p.stop - p.start for p in rows.pieces), default=0)
    if longest >= plan.shortest:
        return ()
    return (
        f"longest unbroken tracking after settling is {longest * plan.step_s:.1f} s, "
        f"{plan.shortest * plan.step_s:.1f} s are needed",
    )
