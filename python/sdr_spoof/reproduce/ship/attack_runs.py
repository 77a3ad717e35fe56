"""Runs of one attack with the default set, and what is kept of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import published
from .attacks import THREE
from .simulation import ATTACK_S, Case, default_set, horizontal_m, runs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.tight import TightConfig, TightSolution
    from sdr_spoof.reproduce.study import Effort

    from .attacks import Named

    Floats = NDArray[np.float64]

BEGIN, END = (round(t) for t in ATTACK_S)
SETTLING = 20
"""The error after an attack is the median of so many seconds."""


@dataclass(frozen=True)
class Outcome:
    """R runs of one attack that began while all satellites were trusted."""

    named: Named
    delay_s: Floats
    """Of the first alarm in the attack; NaN without one (R,)."""
    held: NDArray[np.bool_]
    """Whether the attack was still known, or of the clock alone, when it ended (R,)."""
    early: int
    """Runs with an alarm before the attack."""
    largest_m: Floats
    """Largest error while it was on the air (R,)."""
    after_m: Floats
    """Error 100 to 120 s after its end, median (R,)."""
    median_m: Floats
    """Median error of all runs (E,)."""
    named_right: float
    """Share of the runs in which exactly the satellites attacked were left out at some time."""
    said: str
    """What the first run says of its last alarm."""

    @property
    def found(self) -> float:
        """Share of the runs with an alarm during the attack."""
        return float(np.isfinite(self.delay_s).mean())

    @property
    def median_s(self) -> float:
        """Median delay of all runs; infinite where more than half of them see nothing."""
        return float(np.median(np.where(np.isnan(self.delay_s), np.inf, self.delay_s)))


def outcome(named: Named, effort: Effort, config: TightConfig | None = None) -> Outcome:
    """Run an attack."""
    case = Case((named.attack,), config=config or default_set(), runs=effort.runs)
    everything = list(runs(case, effort))
    # A run in which a false alarm lasts says nothing of this attack.
    made = [s for s in everything if s.state[BEGIN - 1] == 1]
    error = np.array([horizontal_m(s) for s in made])
    settled = END + round(published.BACK_S)
    return Outcome(
        named=named,
        delay_s=np.array([_delay(s) for s in made]),
        held=np.array([_held(s, e) for s, e in zip(made, error, strict=True)]),
        early=sum(s.first_alarm_s < BEGIN for s in everything),
        largest_m=error[:, BEGIN:END].max(axis=1),
        after_m=np.median(error[:, settled - SETTLING : settled], axis=1),
        median_m=np.median(error, axis=0),
        named_right=float(np.mean([_right(s) for s in made])),
        said=next((e.words() for e in reversed(made[0].events) if e.test), ""),
    )


def _delay(s: TightSolution) -> float:
    times = [e.time_s for e in s.events if e.test and BEGIN <= e.time_s < END]
    return times[0] - BEGIN if times else float("nan")


def _held(s: TightSolution, error: Floats) -> bool:
    """Found, and not taken for a false alarm before the end."""
    return bool(
        np.isfinite(_delay(s)) and (s.state[END - 1] != 1 or error[END - 1] < published.BACK_M)
    )


def _right(s: TightSolution) -> bool:
    return any(e.state == "partial" and set(e.excluded) == set(THREE) for e in s.events)
