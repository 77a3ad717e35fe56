"""What the antenna's own motion about the IMU, and its clock, leave between phases and a free INS.

A body that turns moves an antenna at the arm r by (C - C') r beside its IMU from one epoch to the
next, C from body to local axes; a wrong arm leaves (C - C') d between the displacement by carrier
phase and that of the INS, a clock that is off by tau leaves tau (v - v'). Both are found by least
squares, pieces of half a minute each freed from a parabola, which is all that the errors of an INS
can be so soon. Beside them stands a small turn of the attitude, (p - p') x phi. Epochs beyond four
deviations do not count.

One is called wrong where it explains a good part of what is left, beyond any chance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.detectors.changes import at_epochs, changes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.detectors.changes import Changes, States
    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements

    Floats = NDArray[np.float64]
    Three = tuple[float, float, float]

PIECE_S = 30.0
LEAST_EPOCHS = 8
"""Of a piece."""
LEAST_FREE = 20
"""Degrees of freedom."""
SHARE, CHI_SQUARE = 0.3, 40.0
"""From which on it is wrong: share of the squares explained, and their sum over the noise's."""
SURE = 5.0
"""Deviations of one component of the arm: other misfits give large ones that are vague."""
VAGUE_M = 20.0
"""A component of the arm that is known no better is not told."""
MOST_LEFT = 4.0
"""Noises: with more left, something else is wrong, such as the axes."""
FARTHEST_M = 60.0
"""An arm that long is none."""
LEAST_M, LEAST_S = 0.2, 0.02
"""Errors of arm and clock that do no harm."""
LEAST_VARIANCE = 0.01
"""Of a phase over its configured one: what is left is taken as it is, as long as it is possible."""
HALF_S = 0.05
"""Half of the step over which the antenna's velocity is taken."""
OUTLIER = 4.0
PASSES = 3
ARM, CLOCK, ALL = slice(0, 3), slice(3, 4), 7
"""Columns of the fit; the last three are the attitude."""


@dataclass(frozen=True)
class Swing:
    """What is found; the lever arm forward, right, down."""

    given_m: Three
    """Lever arm in use."""
    arm_m: Three
    arm_sigma_m: Three
    clock_s: float
    """Time by the IMU's clock less GNSS time."""
    clock_sigma_s: float
    arm_share: float
    """Part of the squares that a difference of the lever arm explains."""
    arm_chi_square: float
    clock_share: float
    clock_chi_square: float
    left: float
    """What neither explains, over the noise of the phases."""

    @property
    def arm_wrong(self) -> bool:
        """Whether the lever arm in use is contradicted, and another one found."""
        told = zip(self.given_m, self.arm_m, self.arm_sigma_m, strict=True)
        found = any(
            sigma < VAGUE_M and abs(arm - given) > max(SURE * sigma, LEAST_M)
            for given, arm, sigma in told
        )
        possible = float(np.linalg.norm(self.arm_m)) < FARTHEST_M and self.left < MOST_LEFT
        return found and possible and self.arm_share > SHARE and self.arm_chi_square > CHI_SQUARE

    @property
    def clock_wrong(self) -> bool:
        """Whether the clocks are."""
        found = abs(self.clock_s) > LEAST_S and self.left < MOST_LEFT
        return found and self.clock_share > SHARE and self.clock_chi_square > CHI_SQUARE


def swing(measurements: Measurements, states: InertialStates, config: RateConfig) -> Swing | None:
    """Lever arm and clock by phases and INS; None where there is too little to tell.

    Args:
        measurements: epochs that may be looked at.
        states: of a free INS over them, from one alignment.
        config: noise of the phases.

    Raises:
        NavigationError: INS and measurements do not overlap.
    """
    ins = at_epochs(measurements, states)
    found = changes(measurements, states, config)
    later, sooner = (
        at_epochs(replace(measurements, time_s=measurements.time_s + h), states)
        for h in (HALF_S, -HALF_S)
    )
    left, columns, unknowns = _freed(found, _columns(ins, found, (later, sooner)))
    keep = np.ones(left.size, bool)
    for _ in range(PASSES):
        free = int(keep.sum()) - unknowns - ALL
        if free < LEAST_FREE:
            return None
        last = keep
        solution = np.linalg.lstsq(columns[last], left[last], rcond=None)[0]
        off = left - columns @ solution
        variance = max(float(off[last] @ off[last]) / free, LEAST_VARIANCE)
        keep = np.abs(off) < OUTLIER * np.sqrt(variance)
    sigma = np.sqrt(np.diag(np.linalg.pinv(columns[last].T @ columns[last])) * variance)
    arm = np.array(measurements.lever_arm_m) + solution[ARM]
    rest = float(off[last] @ off[last])
    by_arm, by_clock = (
        _squares(left[last], np.delete(columns[last], which, axis=1)) - rest
        for which in (ARM, CLOCK)
    )
    return Swing(
        measurements.lever_arm_m,
        _three(arm),
        _three(sigma[ARM]),
        float(solution[3]),
        float(sigma[3]),
        by_arm / (by_arm + rest),
        by_arm / variance,
        by_clock / (by_clock + rest),
        by_clock / variance,
        float(np.sqrt(variance)),
    )


def _columns(ins: States, found: Changes, around: tuple[States, States]) -> Floats:
    """What each unknown does to the displacement, east, north, up, (E, 3, 7)."""
    later, sooner = around
    velocity = (later.position_m - sooner.position_m) / (2 * HALF_S)
    turned, gained, moved = (
        np.diff(values, axis=0, prepend=values[:1] * np.nan)
        for values in (ins.attitude, velocity, ins.position_m)
    )
    x, y, z = np.einsum("eij,ej->ie", found.axes, moved)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    tilted = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    clock = np.einsum("eij,ej->ei", found.axes, gained)
    return np.concatenate([found.axes @ turned, clock[..., None], tilted], axis=-1)


def _freed(found: Changes, columns: Floats) -> tuple[Floats, Floats, int]:
    """Both sides over their noise and without a parabola in each piece; (N,), (N, 7), unknowns."""
    noise = np.sqrt(2 * np.diagonal(found.covariance_m2, axis1=1, axis2=2))
    both = np.concatenate([found.displacement_m[..., None], columns], axis=-1) / noise[..., None]
    known = np.isfinite(both).all(axis=(1, 2)) & (found.segment >= 0)
    piece = np.floor((found.time_s - found.time_s[0]) / PIECE_S)
    kept = []
    for number in np.unique(piece[known]):
        rows = np.flatnonzero(known & (piece == number))
        if rows.size < LEAST_EPOCHS:
            continue
        middle = found.time_s[rows] - found.time_s[rows].mean()
        base = np.linalg.qr(np.vander(middle / PIECE_S, 3))[0]
        flat = both[rows].reshape(rows.size, -1)
        kept.append((flat - base @ (base.T @ flat)).reshape(-1, both.shape[-1]))
    whole = np.concatenate(kept) if kept else np.empty((0, both.shape[-1]))
    return whole[:, 0], whole[:, 1:], 9 * len(kept)


def _squares(left: Floats, columns: Floats) -> float:
    """Sum of what these columns leave."""
    off = left - columns @ np.linalg.lstsq(columns, left, rcond=None)[0]
    return float(off @ off)


def _three(values: Floats) -> Three:
    x, y, z = (float(v) for v in values)
    return x, y, z
