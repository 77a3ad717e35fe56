"""How the noise of a recording rises, and what gain its quantiser gets.

``<recording>.agc.csv`` holds the gain, as a recorder that knows it writes it down.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof import _core
from sdr_spoof.gain import GainLog

from .emitters import transmissions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .knots import Knots
    from .model import Scenario
    from .recording_plan import RecordingPlan

_LOG_STEPS = 10
"""Rows of the log in a time constant: of a step of 10 dB a line between them is right to 0.02 dB.
"""
_DIGITS = 3


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


def gain_log(scenario: Scenario, duration_s: float | None = None) -> GainLog | None:
    """What the control writes down over the recording, or a part of it; None without a control.

    Rows between which nothing changes are left out.
    """
    plan = scenario.recording
    if plan.agc is None:
        return None
    control = gain_control(plan, [t.emitter for t in transmissions(scenario)])
    assert control is not None
    duration_s = plan.duration_s if duration_s is None else duration_s
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
