"""How far a free INS is off, as far as its quality allows and the satellites tell.

Places of an INS drift away, by hundreds of metres in an hour, and what satellites differ by then is
no attack. Widening the noise by the growth of the drift would not do: rules add samples up, and a
drift is the same in all of them. So a filter with the error model of :mod:`..detectors.growth`
predicts the error at each epoch from the satellites before it:

    expected difference = G x,    spread = noise + G P G',

x and P the prediction and its covariance. What is left, over its spread, is white and normal
without an attack (innovations), as the rules ask for. The price: what an INS of that quality may do
by itself is learnt, be it a drag. Ranges of DME do not teach the filter: that they are what
satellites and INS say together is tested.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.detectors import budget, growth
from sdr_spoof.aiding.detectors.changes import at_epochs
from sdr_spoof.aiding.rate_config import RateConfig

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import InertialStates, Measurements

    from .config import SequentialConfig
    from .observed import Differences

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Drift:
    """What an INS may do between the epochs."""

    steps: growth.Steps

    @classmethod
    def of(
        cls,
        measurements: Measurements,
        ins: InertialStates,
        config: SequentialConfig,
        rate: RateConfig | None = None,
    ) -> Drift | None:
        """Of the configured grade, after an alignment as good as ``rate`` says.

        None where places of the INS are to be taken as exact.

        Raises:
            NavigationError: INS and measurements do not overlap.
            ConfigError: there is no such grade of IMU.
        """
        if config.ins_grade is None:
            return None
        known = at_epochs(measurements, _whole(ins))
        first = int(np.argmax(np.isfinite(known.position_m[:, 0])))
        age_s = config.ins_aligned_s + known.age_s - known.age_s[first]
        alignment = rate or RateConfig()
        sizes = budget.of(alignment.model_copy(update={"grade": config.ins_grade}))
        return cls(growth.steps(replace(known, age_s=age_s), measurements.time_s, sizes))

    def expected(self, found: Differences, until_s: float = np.inf) -> Differences:
        """The same differences, with what the INS is expected to be off.

        Args:
            found: of the epochs.
            until_s: from then on satellites teach nothing more, and the INS goes on alone.
        """
        error_m, error_m2 = np.zeros_like(found.error_m), np.zeros_like(found.error_m2)
        state, spread = np.zeros(growth.STATES), self.steps.start
        for k in range(found.time_s.size):
            there = self.steps.transition[k]
            state = there @ state
            spread = there @ spread @ there.T + self.steps.noise[k]
            error_m[k] = found.axes @ state[growth.POSITION]
            error_m2[k] = found.axes @ spread[growth.POSITION, growth.POSITION] @ found.axes.T
            if found.time_s[k] < until_s:
                state, spread = _taught(found, k, state, spread)
        return replace(found, error_m=error_m, error_m2=error_m2)


def _taught(found: Differences, epoch: int, state: Floats, spread: Floats) -> tuple[Floats, Floats]:
    """State and covariance after the satellites of an epoch, whose clock is anything."""
    known = found.known(epoch)
    used = known[known < found.count]
    if used.size < 2:
        return state, spread
    # Of an error of the place, a difference has the part along the line of sight.
    design = -found.to[epoch, used] @ found.axes
    across = spread[:, growth.POSITION] @ design.T
    total = design @ across[growth.POSITION] + np.diag(found.sigma_m[epoch, used] ** 2)
    weight = np.linalg.inv(total)
    clock = weight.sum(axis=1)
    weight = weight - np.outer(clock, clock) / clock.sum()
    gain = across @ weight
    left = found.differences_m[epoch, used] - design @ state[growth.POSITION]
    spread = spread - gain @ across.T
    return state + gain @ left, 0.5 * (spread + spread.T)


def _whole(ins: InertialStates) -> InertialStates:
    """With velocities and attitudes where there are none: from the places, and level."""
    velocity, attitude = ins.velocity_m_s, ins.attitude_rad
    if not np.isfinite(velocity).all() and ins.time_s.size > 1:
        velocity = np.gradient(ins.position_m, ins.time_s, axis=0)
    if not np.isfinite(attitude).all():
        attitude = np.zeros_like(attitude)
    return replace(ins, velocity_m_s=velocity, attitude_rad=attitude)
