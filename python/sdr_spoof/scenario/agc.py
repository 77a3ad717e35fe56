"""The end of a recorder's front end: how the noise rises, and what gain the quantiser gets.

Tables ``[recording.agc]`` and ``[[recording.noise]]``. ``<recording>.agc.csv`` holds the gain, as a
recorder that knows it writes it down.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import numpy as np
from pydantic import BaseModel, Field, model_validator

from sdr_spoof import _core
from sdr_spoof.gain import GainLog

from .base import FROZEN

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .knots import Knots
    from .recording_plan import RecordingPlan

_LOG_STEPS = 10
"""Rows of the log in a time constant: a straight line between them is right to 0.02 dB."""
_DIGITS = 3


class NoisePoint(BaseModel):
    """One of ``[[recording.noise]]``."""

    model_config = FROZEN

    time_s: float = Field(description="when")
    rise_db: float = Field(
        ge=-30,
        le=60,
        description="noise over its nominal density: interference as wide as the "
        "band; a straight line in dB to the next point, constant before the first and after the "
        "last",
    )


class AgcTable(BaseModel):
    """Table ``[recording.agc]``: the gain follows the power at the quantiser's input."""

    model_config = FROZEN

    time_constant_s: float = Field(
        0.1, gt=0, description="in which a step of the power is followed to 1 - 1/e, in dB"
    )
    update_s: float = Field(
        0.001, gt=0, description="the gain is set so often, constant in between"
    )
    min_gain_db: float = Field(
        -60.0, description="least gain; at 0 dB the noise alone has its nominal level"
    )
    max_gain_db: float = Field(20.0, description="largest gain")

    @model_validator(mode="after")
    def _ascends(self) -> Self:
        if self.min_gain_db > self.max_gain_db:
            raise ValueError(
                f"min_gain_db {self.min_gain_db:g} is above max_gain_db {self.max_gain_db:g}; "
                "exchange them"
            )
        return self


def noise_knots(plan: RecordingPlan) -> Knots:
    """Level of the noise over time, in dB."""
    return [(p.time_s, p.rise_db) for p in plan.noise]


def gain_control(
    plan: RecordingPlan, emitters: Sequence[_core.Emitter]
) -> _core.GainControl | None:
    """The gain for what is on the air; None without a control."""
    if plan.agc is None:
        return None
    return _core.GainControl(
        plan.sample_format,
        plan.sample_rate_hz,
        plan.lo_hz,
        emitters,
        duration_s=plan.duration_s,
        time_constant_s=plan.agc.time_constant_s,
        update_s=plan.agc.update_s,
        range_db=(plan.agc.min_gain_db, plan.agc.max_gain_db),
        noise_db=noise_knots(plan),
        bandwidth_hz=plan.bandwidth_hz,
        centre_hz=plan.front_end_centre_hz,
        filter_taps=plan.filter_taps,
    )


def gain_log(
    plan: RecordingPlan, emitters: Sequence[_core.Emitter], duration_s: float
) -> GainLog | None:
    """What the control writes down; rows between which nothing changes are left out."""
    control = gain_control(plan, emitters)
    if control is None or plan.agc is None:
        return None
    step_s = max(plan.agc.update_s, plan.agc.time_constant_s / _LOG_STEPS)
    time_s = np.arange(0.0, duration_s + step_s, step_s)
    gain_db = np.round(control.gain_db(time_s), _DIGITS)
    same = np.zeros(time_s.size, dtype=np.bool_)
    same[1:-1] = (gain_db[1:-1] == gain_db[:-2]) & (gain_db[1:-1] == gain_db[2:])
    return GainLog(time_s[~same], gain_db[~same])


def front_end_truth(
    plan: RecordingPlan, emitters: Sequence[_core.Emitter], time_s: NDArray[np.float64]
) -> dict[str, Any] | None:
    """Level of the noise, power at the quantiser's input and gain; None where all are constant."""
    control = gain_control(plan, emitters)
    if control is None and not plan.noise:
        return None
    told: dict[str, Any] = {"noise_db": [0.0] * time_s.size, "input_db": None, "gain_db": None}
    if plan.noise:
        points, rises = zip(*noise_knots(plan), strict=True)
        told["noise_db"] = np.round(np.interp(time_s, points, rises), 6).tolist()
    if control is not None:
        told["input_db"] = np.round(control.input_db(time_s), 6).tolist()
        told["gain_db"] = np.round(control.gain_db(time_s), 6).tolist()
    return told
