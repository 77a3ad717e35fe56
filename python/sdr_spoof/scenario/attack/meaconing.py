"""Meaconing: everything that is received is sent again, later and louder."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from sdr_spoof.scenario.base import SPEED_OF_LIGHT, NonNegative
from sdr_spoof.scenario.knots import Knots, integrated

from .base import Emission, OnAir, Target

if TYPE_CHECKING:
    from sdr_spoof.scenario.draw import Draw
    from sdr_spoof.scenario.satellite import Satellite


class Meaconing(OnAir):
    """Re-transmission of all signals, or of those named, with one delay and one gain.

    The repeater's own noise is not modelled, nor that of what it receives.
    """

    role: ClassVar[str] = "meacon"

    kind: Literal["meaconing"] = Field("meaconing", description="kind of attack")
    delay_m: NonNegative = Field(description="delay against the direct signal, in metres of light")
    gain_db: float = Field(3.0, description="power against the direct signal")
    gain_start_db: float | None = Field(
        None, description="power at start_s, from which it rises (default: gain_db)"
    )
    gain_ramp_s: NonNegative = Field(0.0, description="time in which the power rises")
    delay_rate_m_s: float = Field(0.0, description="growth of the delay, of the repeater's clock")
    delay_start_s: NonNegative | None = Field(
        None, description="start of that growth (default: start_s)"
    )
    carrier: Literal["coherent", "frequency-locked"] = Field(
        "coherent",
        description="coherent: the carrier moves with the delay; frequency-locked: the code alone",
    )
    carrier_offset_hz: float = Field(0.0, description="carrier offset, the same for all signals")
    carrier_phase_cycles: float | Literal["geometric", "random"] = Field(
        "geometric",
        description="phase against the direct signal at start_s: a number; geometric (that of the "
        "delay); random (that of the delay and one of the repeater, one for each signal)",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.gain_start_db is not None and not self.gain_ramp_s:
            raise ValueError("gain_start_db needs gain_ramp_s, the time of the rise")
        if self.gain_ramp_s and self.gain_start_db is None:
            raise ValueError("gain_ramp_s needs gain_start_db, the power at start_s")
        if self.delay_start_s is not None and not self.delay_rate_m_s:
            raise ValueError("delay_start_s needs delay_rate_m_s; add it or remove delay_start_s")
        if self.delay_start_s is not None and self.delay_start_s < self.start_s:
            raise ValueError(
                f"delay_start_s {self.delay_start_s:g} is before start_s {self.start_s:g}; "
                "make it later"
            )
        return self

    @property
    def growth_start_s(self) -> float:
        """When the delay begins to grow."""
        return self.start_s if self.delay_start_s is None else self.delay_start_s

    def emissions(self, target: Target, draw: Draw) -> list[Emission]:
        """The target's component, later."""
        rate: Knots = [(self.growth_start_s, 0.0), (self.growth_start_s, self.delay_rate_m_s)]
        carrier_hz = target.spec.carrier_hz
        scale = -carrier_hz / SPEED_OF_LIGHT if self.carrier == "coherent" else 0.0
        carrier = [(t, v * scale + self.carrier_offset_hz) for t, v in rate]
        return [
            Emission(
                start_s=self.start_s,
                end_s=self.end_s,
                power_db=self._power_db(),
                code_offset_m=integrated(rate, self.delay_m),
                carrier_offset_hz=[
                    (self.start_s, 0.0),
                    (self.start_s, self.carrier_offset_hz),
                    *carrier,
                ],
                phase_cycles=self._phase_cycles(target, draw),
            )
        ]

    def timeline(self, satellite: Satellite, signals: tuple[str, ...]) -> dict[str, Any]:
        """Times and sizes."""
        del satellite, signals
        return {
            "start_s": self.start_s,
            "delay_start_s": self.growth_start_s if self.delay_rate_m_s else None,
            "end_s": self.end_s,
            "delay_m": self.delay_m,
            "delay_rate_m_s": self.delay_rate_m_s,
            "power_db": self.gain_db,
            "carrier": self.carrier,
            "carrier_offset_hz": self.carrier_offset_hz,
        }

    def _power_db(self) -> Knots:
        if self.gain_start_db is None:
            return [(self.start_s, self.gain_db)]
        ramp_end_s = self.start_s + self.gain_ramp_s
        return [(self.start_s, self.gain_start_db), (ramp_end_s, self.gain_db)]

    def _phase_cycles(self, target: Target, draw: Draw) -> float:
        if not isinstance(self.carrier_phase_cycles, str):
            return self.carrier_phase_cycles
        delay = -math.fmod(self.delay_m * target.spec.carrier_hz / SPEED_OF_LIGHT, 1.0)
        own = self.carrier_phase_cycles == "random"
        return delay + (draw("repeater", target.spec.carrier_hz) if own else 0.0)
