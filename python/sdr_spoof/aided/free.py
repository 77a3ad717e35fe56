"""The free INS, a witness that no satellite leads, and the tests of rates that it is asked in.

It starts from what the filter knows once it has settled, and is as uncertain as that. A gap of the
IMU that is too long to be bridged ends it; the next one starts when the filter has settled anew.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.increments import BRIDGE_S, gaps
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.aiding.strapdown import navigate

from .filtered import body_velocity
from .rates import Rates, examine, joined

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sdr_spoof.aiding.records import ImuLog, Measurements
    from sdr_spoof.aiding.tight import TightSolution
    from sdr_spoof.config import Config

STATES_HZ = 10.0
"""Rate of the states of the free INS, at least."""


def rates(
    log: ImuLog, measurements: Measurements, solution: TightSolution, config: Config
) -> tuple[InertialStates | None, Rates]:
    """The free INS, and the tests with it.

    Args:
        log: increments by the clock of the measurements.
        measurements: of the receiver.
        solution: of the filter, with the same epochs.
        config: its groups ``aided``, ``tight``, ``rate`` and ``detection``.
    """
    found = []
    for piece, row in _pieces(log, solution, config.tight.settle_s):
        begin = state_of(log, solution, row)
        free = navigate(piece, begin, every=max(1, round(1 / (STATES_HZ * log.interval_s))))
        last = int(np.searchsorted(measurements.time_s, piece.time_s[-1], side="right"))
        seen = examine(measurements.part(row, last), free, aligned(config, solution, row))
        found.append((free, seen))
    if not found or not config.aided.detectors:
        note = f"rates: the filter has not settled within {config.tight.settle_s:g} s"
        return None, Rates((), (), (note,), (), 0.0)
    states = [free for free, _ in found]
    return _together(states), joined([seen for _, seen in found], measurements.time_s)


def _pieces(log: ImuLog, solution: TightSolution, settle_s: float) -> Iterator[tuple[ImuLog, int]]:
    """Increments between long gaps, and the first settled epoch of each."""
    ends = [float(g.start_s) for g in gaps(log) if g.length_s > BRIDGE_S]
    cuts = np.searchsorted(log.time_s, [*ends, np.inf], side="right")
    valid_s = solution.time_s[int(np.argmax(solution.valid))]
    first = 0
    for last in cuts.tolist():
        piece = log.part(first, last)
        begins = max(valid_s, piece.time_s[0] - log.interval_s)
        settled = solution.valid & (solution.time_s >= begins + settle_s)
        settled &= solution.time_s < piece.time_s[-1]
        if settled.any():
            yield piece, int(np.argmax(settled))
        first = last


def state_of(log: ImuLog, solution: TightSolution, row: int) -> InertialStates:
    """What the filter says at an epoch, as a state to navigate from."""
    one = slice(row, row + 1)
    return InertialStates(
        log.reference,
        solution.time_s[one],
        solution.position_m[one],
        body_velocity(solution)[one],
        solution.attitude_rad[one],
        np.zeros(1),
    )


def aligned(config: Config, solution: TightSolution, row: int) -> Config:
    """With what the filter says of its errors there, where the configuration says nothing."""
    sigma = np.sqrt(np.diagonal(solution.covariance[row], axis1=1, axis2=2))
    known = {
        "align_position_m": float(sigma[0].max()),
        "align_velocity_m_s": float(sigma[1].max()),
        "align_level_deg": float(np.degrees(sigma[2, :2].max())),
        "align_heading_deg": float(np.degrees(sigma[2, 2])),
    }
    own = config.rate.model_fields_set
    rate = config.rate.model_copy(update={k: v for k, v in known.items() if k not in own})
    return config.model_copy(update={"rate": rate})


def _together(states: list[InertialStates]) -> InertialStates:
    return InertialStates(
        states[0].reference,
        np.concatenate([s.time_s for s in states]),
        np.concatenate([s.position_m for s in states]),
        np.concatenate([s.velocity_m_s for s in states]),
        np.concatenate([s.attitude_rad for s in states]),
        np.concatenate([s.aligned_s for s in states]),
    )
