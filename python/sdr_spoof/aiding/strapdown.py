"""From increments of an IMU to positions, velocities and attitudes; one run, or many at once.

The arithmetic is in the core (``rust/core/src/inertial``): quaternion attitude with coning and
sculling from three increments, Earth rate, transport rate, normal gravity with height, reckoned in
local or in Earth-fixed axes. Nothing holds the vertical channel, whose errors grow by e in ten
minutes, unless an altimeter does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import InertialError

from . import increments
from .navigation_plan import Altimeter, Mechanisation, Plan, plan, rows
from .records import ImuLog, InertialStates

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime

    from .imu.errors import ImuErrors


@dataclass(frozen=True)
class RunStates:
    """What R runs say at the same M times; otherwise as :class:`InertialStates`."""

    reference: GnssTime | None
    time_s: NDArray[np.float64]
    """(M,)"""
    position_m: NDArray[np.float64]
    """(R, M, 3)"""
    velocity_m_s: NDArray[np.float64]
    """Earth-fixed, (R, M, 3)."""
    attitude_rad: NDArray[np.float64]
    """Yaw, pitch, roll (R, M, 3)."""
    aligned_s: NDArray[np.float64]
    """Seconds since the last alignment, (M,)."""

    def run(self, number: int) -> InertialStates:
        """The states of one run."""
        return InertialStates(
            self.reference,
            self.time_s,
            self.position_m[number],
            self.velocity_m_s[number],
            self.attitude_rad[number],
            self.aligned_s,
        )


def navigate(
    log: ImuLog,
    start: InertialStates,
    *,
    every: int = 1,
    realign: InertialStates | None = None,
    altimeter: Altimeter | None = None,
    mechanisation: Mechanisation = "local",
    bridge_s: float = increments.BRIDGE_S,
) -> InertialStates:
    """Navigates with one IMU.

    Args:
        log: Increments, in body axes.
        start: State to begin with, one row; increments that end before it are left out.
        every: A row of output each so many increments.
        realign: States that replace the reckoned ones at their times, ascending.
        altimeter: Holds the vertical channel.
        mechanisation: Axes in which is reckoned.
        bridge_s: Gaps up to here are bridged (see :func:`increments.bridged`); after a longer one
            there must be a new alignment.

    Returns:
        States at ``start`` and after each ``every`` increments.

    Raises:
        InertialError: unusable increments, a start outside the log, a long gap without a new
            alignment, or a place too near to a pole for local axes.
    """
    planned = plan(
        log,
        start,
        every=every,
        realign=realign,
        altimeter=altimeter,
        mechanisation=mechanisation,
        bridge_s=bridge_s,
    )
    return _run(planned, [], None).run(0)


def navigate_runs(
    ideal: ImuLog,
    start: InertialStates,
    errors: Sequence[ImuErrors],
    *,
    every: int = 1,
    realign: InertialStates | None = None,
    alignment_errors: NDArray[np.float64] | None = None,
    altimeter: Altimeter | None = None,
    mechanisation: Mechanisation = "local",
    bridge_s: float = increments.BRIDGE_S,
) -> RunStates:
    """Navigates with many IMUs through the same motion, in parallel.

    A run depends on its errors only, not on how many others there are.

    Args:
        ideal: Increments of an IMU without errors.
        start: True state at the beginning, one row.
        errors: Of each run's IMU, R of them.
        every: A row of output each so many increments.
        realign: True states at the times of new alignments, K rows, ascending.
        alignment_errors: What each alignment adds to the truth, at the start and at each new
            alignment, (R, K + 1, 9): position (north, east, down, m), velocity (m/s), attitude
            (phi about the same axes, rad; the state says (1 - phi x) times the truth). None: none.
        altimeter: Holds the vertical channel.
        mechanisation: Axes in which is reckoned.
        bridge_s: As of :func:`navigate`.

    Raises:
        InertialError: as :func:`navigate`, or alignment errors of another shape.
    """
    planned = plan(
        ideal,
        start,
        every=every,
        realign=realign,
        altimeter=altimeter,
        mechanisation=mechanisation,
        bridge_s=bridge_s,
    )
    shape = (len(errors), len(planned.after) + 1, 9)
    if alignment_errors is not None and alignment_errors.shape != shape:
        raise InertialError(
            f"alignment errors have shape {alignment_errors.shape}: give {shape} for "
            f"{shape[0]} runs and {shape[1]} alignments"
        )
    if not errors:
        raise InertialError("no runs: give the errors of at least one IMU")
    given = None if alignment_errors is None else np.ascontiguousarray(alignment_errors)
    return _run(planned, errors, given)


def row(states: InertialStates, number: int) -> InertialStates:
    """One row of states, to start from."""
    one = slice(number, number + 1) if number != -1 else slice(-1, None)
    return InertialStates(
        states.reference,
        states.time_s[one],
        states.position_m[one],
        states.velocity_m_s[one],
        states.attitude_rad[one],
        states.aligned_s[one],
    )


def _run(
    planned: Plan, errors: Sequence[ImuErrors], alignments: NDArray[np.float64] | None
) -> RunStates:
    realign = planned.realign
    states = _core.inertial_navigate(
        *planned.arrays(),
        every=planned.every,
        errors=list(errors),
        alignments=alignments,
        realigned=None if realign is None else (planned.after, rows(realign)),
        vertical=planned.vertical,
        earth_fixed=planned.mechanisation == "earth-fixed",
    )
    if not np.isfinite(states).all():
        raise InertialError(
            "the INS has run away to where no number tells: look at the increments, and use "
            "earth-fixed axes near the poles"
        )
    return RunStates(
        planned.log.reference,
        planned.output_s(),
        states[..., :3],
        states[..., 3:6],
        states[..., 6:],
        planned.aligned_s(),
    )
