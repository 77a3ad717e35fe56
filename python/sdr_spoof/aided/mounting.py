"""Whether the antenna swings about the IMU as the lever arm says.

A body that turns at w moves an antenna at the arm r by C (w x r) beside its IMU, C from body to
local axes. A wrong arm leaves C (w x d) between the velocity by GNSS and that of the INS, which the
filter takes for what spoofers do. Here d is found by least squares over the time before the first
alarm, pieces of half a minute each freed from a parabola, which is all that the errors of an INS
can be so soon. Beside d stand what could be mistaken for it: a small turn of the attitude, v x phi,
and clocks that differ, tau dv/dt. Epochs beyond four deviations do not count.

The arm is called wrong where d explains a good part of what is left, beyond any chance. It is no
test for spoofing: what begins later than the filter is not looked at.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.increments import BRIDGE_S, gaps
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.aiding.strapdown import navigate
from sdr_spoof.scenario.sky.trajectory import rotations

from . import alone
from .start import rate_rad_s, to_earth

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import ImuLog, Measurements
    from sdr_spoof.aiding.tight import Start

    Floats = NDArray[np.float64]

PIECE_S = 30.0
LEAST_EPOCHS = 8
"""Of a piece."""
LONGEST_S = 300.0
"""More adds nothing."""
LEAST_FREE = 40
"""Degrees of freedom."""
SHARE, CHI_SQUARE = 0.3, 40.0
"""From which on the arm is wrong: share of the squares explained, and of three degrees of freedom.
With the right one the receiver's own errors gave up to 0.12 and 8 (docs/validation.md)."""
LEAST_NOISE_M_S = 0.005
"""No receiver's velocity is better."""
OUTLIER = 4.0
PASSES = 3
HALF_S = 0.05
"""Half of the step of accelerations."""
ARM, OTHERS = slice(0, 3), slice(3, None)
"""Columns of the fit."""


@dataclass(frozen=True)
class Mounting:
    """What the swing of the antenna tells of its lever arm."""

    given_m: tuple[float, float, float]
    found_m: tuple[float, float, float]
    sigma_m: tuple[float, float, float]
    share: float
    """Part of the squares that the difference of both explains."""
    chi_square: float
    """Of that difference, three degrees of freedom."""

    @property
    def wrong(self) -> bool:
        """Whether the given one is contradicted."""
        return self.share > SHARE and self.chi_square > CHI_SQUARE

    def words(self) -> str:
        """In a sentence."""
        found = ", ".join(
            f"{v:.1f} ± {s:.1f}" for v, s in zip(self.found_m, self.sigma_m, strict=True)
        )
        given = ",".join(f"{v:g}" for v in self.given_m)
        return (
            f"the antenna swings about the IMU as at {found} m (forward, right, down), not as at "
            f"the lever arm of {given} m: alarms may come of that; give --lever-arm as measured"
        )


def examine(
    log: ImuLog, measurements: Measurements, start: Start, until_s: float
) -> Mounting | None:
    """The lever arm by GNSS and gyros; None where there is too little to tell.

    Args:
        log: increments by the clock of the measurements.
        measurements: of the receiver.
        start: state to navigate from.
        until_s: first alarm, or the end.
    """
    log = _before(log, start.time_s, min(until_s, start.time_s + LONGEST_S))
    places = alone.places(measurements)
    velocity = alone.velocities(measurements, places)
    good = (measurements.time_s > start.time_s + HALF_S) & np.isfinite(velocity).all(axis=1)
    good &= measurements.time_s < (log.time_s[-1] if log.time_s.size else -np.inf) - HALF_S
    if good.sum() < LEAST_EPOCHS:
        return None
    time_s, local = measurements.time_s[good], np.stack([to_earth(p) for p in places[good]])
    given = np.array(measurements.lever_arm_m)
    columns, reckoned = _columns(log, time_s, local, start)
    left = np.einsum("exi,ex->ei", local, velocity[good]) - reckoned - columns[..., ARM] @ given
    return _solved(*_freed(time_s, left, columns), measurements.lever_arm_m)


def _before(log: ImuLog, start_s: float, until_s: float) -> ImuLog:
    """Up to a time, or to the first gap after the start that is too long to be bridged."""
    long = [g.start_s for g in gaps(log) if g.length_s > BRIDGE_S and g.start_s > start_s]
    return log.part(0, int(np.searchsorted(log.time_s, min([until_s, *long]), side="right")))


def _columns(log: ImuLog, time_s: Floats, local: Floats, start: Start) -> tuple[Floats, Floats]:
    """What each unknown does to the velocity, (E, 3, 7), and that of the IMU's point (E, 3)."""
    begin = InertialStates(
        log.reference,
        np.array([start.time_s]),
        np.array([start.position_m]),
        np.array([start.velocity_m_s]),
        np.array([start.attitude_rad]),
        np.zeros(1),
    )
    free = navigate(log, begin)

    def at(shift_s: float) -> Floats:
        moved = [np.interp(time_s + shift_s, free.time_s, v) for v in free.velocity_m_s.T]
        return np.asarray(np.einsum("exi,xe->ei", local, np.array(moved)))

    row = np.clip(np.searchsorted(free.time_s, time_s), 0, free.time_s.size - 1)
    turns = rotations(free.attitude_rad[row])
    rates = np.stack([rate_rad_s(log, t) for t in time_s])
    velocity = at(0.0)
    gained = (at(HALF_S) - at(-HALF_S)) / (2 * HALF_S)
    parts = [turns @ _cross(rates), _cross(velocity), gained[..., None]]
    return np.concatenate(parts, axis=-1), velocity


def _cross(vectors: Floats) -> Floats:
    """Matrices of the product with vectors (E, 3): (E, 3, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _freed(time_s: Floats, left: Floats, columns: Floats) -> tuple[Floats, Floats, int]:
    """Both sides without a parabola in each piece, (N,) and (N, 7), and the number of unknowns."""
    both = np.concatenate([left[..., None], columns], axis=-1)
    piece = np.floor((time_s - time_s[0]) / PIECE_S)
    kept = []
    for number in np.unique(piece):
        rows = np.flatnonzero(piece == number)
        if rows.size < LEAST_EPOCHS:
            continue
        middle = time_s[rows] - time_s[rows].mean()
        base = np.linalg.qr(np.vander(middle / PIECE_S, 3))[0]
        flat = both[rows].reshape(rows.size, -1)
        kept.append((flat - base @ (base.T @ flat)).reshape(-1, both.shape[-1]))
    whole = np.concatenate(kept) if kept else np.empty((0, both.shape[-1]))
    return whole[:, 0], whole[:, 1:], 9 * len(kept)


def _solved(
    left: Floats, columns: Floats, unknowns: int, given: tuple[float, float, float]
) -> Mounting | None:
    keep = np.ones(left.size, bool)
    for _ in range(PASSES):
        free = int(keep.sum()) - unknowns - columns.shape[1]
        if free < LEAST_FREE:
            return None
        found = np.linalg.lstsq(columns[keep], left[keep], rcond=None)[0]
        off = left - columns @ found
        variance = max(float(off[keep] @ off[keep]) / free, LEAST_NOISE_M_S**2)
        last, keep = keep, np.abs(off) < OUTLIER * np.sqrt(variance)
    rest = float(off[last] @ off[last])
    others = columns[last][:, OTHERS]
    without = left[last] - others @ np.linalg.lstsq(others, left[last], rcond=None)[0]
    explained = float(without @ without) - rest
    sigma = np.sqrt(np.diag(np.linalg.pinv(columns[last].T @ columns[last])) * variance)[ARM]
    arm = np.array(given) + found[ARM]
    return Mounting(
        given,
        (float(arm[0]), float(arm[1]), float(arm[2])),
        (float(sigma[0]), float(sigma[1]), float(sigma[2])),
        explained / (rest + explained + LEAST_NOISE_M_S**2),
        explained / variance,
    )
