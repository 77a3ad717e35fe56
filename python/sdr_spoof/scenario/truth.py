"""The truth beside a recording: what was really sent, for comparison and never for detection.

Every quantity is that of the synthesis itself, asked at the times of the table:

- ``code_delay_s``: the received code phase is ``chip_rate (t - code_delay_s)`` chips, chip 0 of
  code period 0, secondary chip 0 and symbol 0 starting at phase 0;
- ``carrier_phase_cycles``: carrier phase in the RINEX sense (grows as range grows): minus the
  received phase over the nominal carrier, at the component's own zero (the 0.25 cycle of the B1C
  pilot is not in it); the phase in the file is ``(carrier - lo_hz) t - carrier_phase_cycles``;
- ``doppler_hz``: positive when approaching;
- ``cn0_dbhz``: of the component, null while off the air;
- ``data_delay_s``, ``data_error_rate``: how its data symbols differ from those of ``data_seed``,
  or of its navigation message (``has_message``);
- ``role``: authentic, spoof, meacon or multipath.

``front_end``, where noise or gain change, has the level of the noise, the power at the quantiser's
input and the gain at the same times, in dB against the nominal noise alone.

``attacks`` has an entry for each attacked satellite, ``disturbances`` one for each that has
multipath, which is no attack. ``sky``, where the scenario has one, tells of the receiver's state
and of the satellites in view, and ``imu`` of what its inertial sensors really went through.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.signals import components, signal_spec

from .attack import Position
from .emitters import AUTHENTIC, Transmission, transmissions
from .front_end import front_end_truth
from .imu_data import imu_of
from .sky.truth import sky_truth

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .attack import Attack
    from .model import Scenario
    from .satellite import Satellite

INTERVAL_S = 0.1
"""Spacing of the table."""
_MAX_ROWS = 1000
"""Longer recordings get a wider spacing."""
_MAX_SKY_ROWS = 36_000
"""An hour."""


def truth(scenario: Scenario, *, sample_count: int | None = None) -> dict[str, Any]:
    """The truth as a JSON-ready dict.

    Args:
        scenario: what was synthesised.
        sample_count: samples really written, if fewer than planned.
    """
    plan = scenario.recording
    count = plan.sample_count if sample_count is None else sample_count
    duration_s = count / plan.sample_rate_hz
    interval_s = _interval_s(scenario, duration_s)
    rows = int(duration_s / interval_s + 1e-9) + 1
    time_s = np.arange(rows, dtype=np.float64) * np.float64(interval_s)
    sent = transmissions(scenario)
    told = {
        "title": scenario.title,
        "sample_count": count,
        "partial": count < plan.sample_count,
        "interval_s": interval_s,
        "definitions": __doc__,
        "attacks": attack_timelines(scenario),
        "disturbances": attack_timelines(scenario, hostile=False),
        "time_s": _rounded(time_s, 9),
        "emitters": [_emitter(t, time_s) for t in sent],
        "scenario": scenario.model_dump(),
    }
    front_end = front_end_truth(plan, [t.emitter for t in sent], time_s)
    if front_end is not None:
        told["front_end"] = front_end
    sky = scenario.sky_model()
    if sky is not None:
        authentic = [t for t in sent if t.role == AUTHENTIC]
        false = [a for a in scenario.attack if isinstance(a, Position)]
        told["sky"] = sky_truth(sky, time_s, authentic, false)
    imu = imu_of(scenario, duration_s=duration_s)
    if imu is not None:
        told["imu"] = imu.truth(time_s)
    return told


def _interval_s(scenario: Scenario, duration_s: float) -> float:
    """Of the table; a sky keeps its 10 Hz longer, and whole multiples of it."""
    if scenario.sky is None:
        return max(INTERVAL_S, duration_s / _MAX_ROWS)
    return INTERVAL_S * max(1, math.ceil(duration_s / INTERVAL_S / _MAX_SKY_ROWS))


def attack_timelines(scenario: Scenario, *, hostile: bool = True) -> list[dict[str, Any]]:
    """The truth's entries: one for each satellite of each attack, or of what is none.

    Each has ``kind``, ``role``, ``system``, ``prn``, ``signals``, ``components``, ``start_s``,
    ``end_s``, ``capture_s`` and ``drag_start_s`` (None where there is no such moment), and what
    its kind adds.
    """
    return [
        _attack(attack, satellite, signals)
        for number, attack in enumerate(scenario.attack)
        if attack.hostile == hostile
        for satellite, signals in scenario.victims(number)
    ]


def _attack(attack: Attack, satellite: Satellite, signals: tuple[str, ...]) -> dict[str, Any]:
    """Whom it is against, and its timeline."""
    return {
        "kind": attack.kind,
        "role": attack.role,
        "system": satellite.system,
        "prn": satellite.prn,
        "signals": list(signals),
        "components": [c for s in signals for c in components(s)],
        "capture_s": None,
        "drag_start_s": None,
    } | attack.timeline(satellite, signals)


def _emitter(t: Transmission, time_s: NDArray[np.float64]) -> dict[str, Any]:
    chips = t.emitter.code_phase_chips(time_s)
    cn0_dbhz = t.emitter.cn0_dbhz(time_s)
    return {
        "role": t.role,
        "system": t.system,
        "prn": t.prn,
        "signal": t.signal,
        "composite": t.composite,
        "data_seed": t.data_seed,
        "has_message": t.has_message,
        "data_delay_s": t.emitter.data_delay_s,
        "data_error_rate": t.data_error_rate,
        "start_s": t.start_s,
        "end_s": t.end_s,
        "code_delay_s": _rounded(time_s - chips / signal_spec(t.signal).chip_rate_hz, 15),
        "carrier_phase_cycles": _rounded(-t.emitter.received_phase_cycles(time_s), 6),
        "doppler_hz": _rounded(t.emitter.doppler_hz(time_s), 6),
        "cn0_dbhz": [round(v, 4) if math.isfinite(v) else None for v in cn0_dbhz.tolist()],
    }


def _rounded(values: NDArray[np.float64], digits: int) -> list[float]:
    return [round(v, digits) for v in values.tolist()]
