"""How a component of a satellite moves: what its emitters, counterfeits too, have in common."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sdr_spoof._core import Spline

    from .knots import Knots


@dataclass(frozen=True)
class Motion:
    """Arguments of the core's emitter, before an attack adds its own."""

    delay_s: float
    phase_cycles: float = 0.0
    doppler_hz: float = 0.0
    doppler_rate_hz_s: float = 0.0
    range_m: Spline | None = None
    """Pseudorange of the carrier."""
    code_offset_m: Knots = field(default_factory=list)
    power_db: Knots = field(default_factory=list)
    start_s: float = -math.inf
    """Above the horizon from here on."""
    end_s: float = math.inf
