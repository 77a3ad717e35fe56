"""Attacks as time profiles: what the spoofer adds to the authentic signal's motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .model import SPEED_OF_LIGHT

if TYPE_CHECKING:
    from .model import InducedAttack

Knots = list[tuple[float, float]]

_STEP_S = 0.02
"""Knot spacing where the drag rate grows; the code is off by drag_rate/drag_ramp step^2/8."""


@dataclass(frozen=True)
class Profiles:
    """Piecewise-linear profiles, lists of (time in s, value)."""

    power_db: Knots
    """Against the authentic signal."""
    code_offset_m: Knots
    carrier_offset_hz: Knots


def profiles(attack: InducedAttack, carrier_hz: float) -> Profiles:
    """Profiles of one attacked signal component."""
    rate = _code_rate_m_s(attack)
    scale = -carrier_hz / SPEED_OF_LIGHT if attack.carrier == "coherent" else 0.0
    return Profiles(
        power_db=[
            (attack.ramp_start_s, attack.power_start_db),
            (attack.ramp_end_s, attack.power_db),
        ],
        code_offset_m=_code_offset_m(attack),
        carrier_offset_hz=[
            (attack.start_s, 0.0),
            *((t, v * scale + attack.carrier_offset_hz) for t, v in rate),
        ],
    )


def drag_offset_hz(attack: InducedAttack, carrier_hz: float) -> float:
    """Carrier offset f_e at the full drag rate."""
    return profiles(attack, carrier_hz).carrier_offset_hz[-1][1]


def capture_time_s(attack: InducedAttack) -> float | None:
    """When the spoofer's power passes the authentic one, if it ever does."""
    first, last = attack.power_start_db, attack.power_db
    if first >= 0:
        return attack.ramp_start_s
    if last <= 0:
        return None
    time = attack.ramp_start_s + attack.power_ramp_s * first / (first - last)
    return time if attack.end_s is None or time < attack.end_s else None


def _code_rate_m_s(attack: InducedAttack) -> Knots:
    """Rate of the code offset; ends with the full drag rate."""
    knots: Knots = []
    if attack.approach_s:
        rate = -attack.approach_offset_m / attack.approach_s
        knots += [(attack.start_s, rate), (attack.ramp_start_s, rate)]
    knots += [(attack.ramp_start_s, 0.0)]
    if attack.drag_start_s is not None:
        full = attack.drag_start_s + attack.drag_ramp_s
        knots += [(attack.drag_start_s, 0.0), (full, attack.drag_rate_m_s)]
    return knots


def _code_offset_m(attack: InducedAttack) -> Knots:
    """Integral of the rate; parabolic while the drag rate grows, then straight to the far end."""
    knots = [(attack.start_s, attack.approach_offset_m), (attack.ramp_start_s, 0.0)]
    if attack.drag_start_s is None:
        return knots
    steps = max(1, round(attack.drag_ramp_s / _STEP_S))
    for k in range(steps + 1):
        into = attack.drag_ramp_s * k / steps
        offset = 0.5 * attack.drag_rate_m_s * into * k / steps
        knots.append((attack.drag_start_s + into, offset))
    far = 1e6  # beyond any recording
    knots.append((knots[-1][0] + far, knots[-1][1] + attack.drag_rate_m_s * far))
    return knots
