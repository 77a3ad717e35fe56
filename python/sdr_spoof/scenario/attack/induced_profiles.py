"""Time profiles of an induced capture, against the authentic signal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.base import SPEED_OF_LIGHT
from sdr_spoof.scenario.knots import Knots, integral, integrated
from sdr_spoof.signals import components, signal_spec

if TYPE_CHECKING:
    from .induced import InducedAttack

_PIECES = 64
"""Straight pieces, in dB, of a curved power profile."""
_PHASES = {"aligned": 0.0, "antipodal": 0.5}


def code_rate_m_s(attack: InducedAttack) -> Knots:
    """Rate of the code offset from ``start_s`` on."""
    knots: Knots = [(attack.start_s, 0.0)]
    if attack.approach_s:
        rate = -attack.approach_offset_m / attack.approach_s
        knots += [(attack.start_s, rate), (attack.ramp_start_s, rate)]
    knots += [(attack.ramp_start_s, 0.0)]
    if attack.drag_start_s is not None:
        start_s, ramp_s, rate = attack.drag_start_s, attack.drag_ramp_s, attack.drag_rate_m_s
        knots += [(start_s, 0.0), (start_s + ramp_s, rate)]
        if attack.drag_end_s is not None:
            knots += [(attack.drag_end_s, rate), (attack.drag_end_s + ramp_s, 0.0)]
    return knots


def code_offset_m(attack: InducedAttack) -> Knots:
    """Integral of the rate; zero when aligned."""
    return integrated(code_rate_m_s(attack), attack.approach_offset_m)


def carrier_offset_hz(attack: InducedAttack, carrier_hz: float) -> Knots:
    """Motion that belongs to the code's, the constant offset, and a seamless takeover's turn."""
    scale = -carrier_hz / SPEED_OF_LIGHT if attack.carrier == "coherent" else 0.0
    rate, start_s = code_rate_m_s(attack), attack.start_s
    knots = [(start_s, 0.0), *((t, v * scale + attack.carrier_offset_hz) for t, v in rate)]
    if attack.takeover == "seamless":
        first, last = _seamless_phases(attack)
        turn = (last - first) / attack.power_ramp_s
        aligned = [(attack.ramp_start_s, turn), (attack.ramp_end_s, turn), (attack.ramp_end_s, 0.0)]
        # The code stands still between the approach, which is before, and the drag, after.
        before = [k for k in knots if k[0] <= attack.ramp_start_s]
        knots = [*before, *aligned, *knots[len(before) :]]
    return knots


def phase_at_zero(attack: InducedAttack, carrier_hz: float, random: float) -> float:
    """Phase at 0 s that gives the one asked for at the moment of alignment."""
    phase = attack.carrier_phase_cycles
    if attack.takeover == "seamless":
        phase = _seamless_phases(attack)[0]
    elif phase == "random":
        phase = random
    elif isinstance(phase, str):
        phase = _PHASES[phase]
    turned = integral(carrier_offset_hz(attack, carrier_hz), attack.start_s, attack.ramp_start_s)
    return phase - turned


def power_db(attack: InducedAttack, chip_rate_hz: float) -> Knots:
    """Power ramp, then the change that goes with the drag."""
    return _rise_db(attack) + _dragged_power_db(attack, SPEED_OF_LIGHT / chip_rate_hz)


def capture_time_s(attack: InducedAttack) -> float | None:
    """When the spoofer's power passes the authentic one, if it ever does."""
    knots = _rise_db(attack)
    powers = [p for _, p in knots]
    index = next((k for k, p in enumerate(powers) if p >= 0), None)
    if index is None or (powers[0] < 0 and attack.final_power_db <= 0):
        return None
    time_s = knots[0][0] if index == 0 else _crossing_s(knots[index - 1], knots[index])
    return time_s if attack.end_s is None or time_s < attack.end_s else None


def full_drag_offset_hz(attack: InducedAttack, signals: tuple[str, ...]) -> dict[str, float]:
    """Carrier offset f_e of each component at the full drag rate."""
    parts = [c for s in signals for c in components(s)]
    rate = attack.drag_rate_m_s if attack.carrier == "coherent" else 0.0
    return {
        c: attack.carrier_offset_hz - rate * signal_spec(c).carrier_hz / SPEED_OF_LIGHT
        for c in parts
    }


def _rise_db(attack: InducedAttack) -> Knots:
    """Power from coming on the air to the end of the ramp."""
    if attack.takeover == "ramp":
        first, last = attack.power_start_db, attack.final_power_db
        return [(attack.ramp_start_s, first), (attack.ramp_end_s, last)]
    phase = np.linspace(*_seamless_phases(attack), _PIECES + 1)
    power = 20 * np.log10(-2 * np.cos(2 * np.pi * phase))
    time = np.linspace(attack.ramp_start_s, attack.ramp_end_s, _PIECES + 1)
    return list(zip(time.tolist(), power.tolist(), strict=True))


def _crossing_s(a: tuple[float, float], b: tuple[float, float]) -> float:
    return a[0] + (b[0] - a[0]) * a[1] / (a[1] - b[1])


def _seamless_phases(attack: InducedAttack) -> tuple[float, float]:
    """Phases at which the amplitude ratio -2 cos(phi) is the first and the last one, in cycles."""
    etas = (10 ** (attack.power_start_db / 20), min(attack.final_eta, 2.0))
    first, last = (math.acos(-eta / 2) / math.tau for eta in etas)
    return first, last


def _dragged_power_db(attack: InducedAttack, chip_m: float) -> Knots:
    """Amplitude ratio in proportion to the offset, up to one chip."""
    if attack.drag_start_s is None or attack.drag_eta is None or not attack.drag_rate_m_s:
        return []
    drag = [k for k in code_offset_m(attack) if k[0] >= attack.drag_start_s]
    times, offsets = np.abs(np.array(drag)).T
    furthest = int(offsets.argmax())
    reached = np.linspace(0.0, min(chip_m, float(offsets[furthest])), _PIECES + 1)
    time = np.interp(reached, offsets[: furthest + 1], times[: furthest + 1])
    eta = attack.final_eta + (attack.drag_eta - attack.final_eta) * reached / chip_m
    return list(zip(time.tolist(), (20 * np.log10(eta)).tolist(), strict=True))
