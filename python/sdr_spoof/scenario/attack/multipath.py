"""Multipath: reflections of a satellite's own signals, the innocent look-alike of an attack."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BaseModel, Field, model_validator

from sdr_spoof.scenario.base import FROZEN, SPEED_OF_LIGHT, NonNegative
from sdr_spoof.scenario.knots import Knots, integrated

from .base import Attack, Emission, Target, check_end

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.scenario.draw import Draw
    from sdr_spoof.scenario.satellite import Satellite

_PIECES = 32
_FLOOR = 0.01
"""Share of the amplitude at which a ray comes and goes."""


class Ray(BaseModel):
    """One reflection: ``[[attack.ray]]``. Same delay in all signals, phase by each carrier."""

    model_config = FROZEN

    ratio: float = Field(gt=0, description="amplitude over that of the direct signal")
    delay_m: NonNegative = Field(description="extra path at the ray's start")
    phase_cycles: float | Literal["random"] = Field(
        "random",
        description="phase against the direct signal at the ray's start: a number, the same in "
        "every signal; or random: that of delay_m at each carrier and a random one of the "
        "reflector, the same in every signal",
    )
    delay_rate_m_s: float = Field(
        0.0, description="growth of the extra path; the carrier moves with it, by -v/lambda"
    )
    phase_rate_hz: float = Field(
        0.0, description="carrier offset without motion of the code, the same in every signal"
    )
    start_s: NonNegative = Field(0.0, description="there from here (0: from before the beginning)")
    end_s: NonNegative | None = Field(None, description="gone from here (default: stays)")
    rise_s: NonNegative = Field(
        0.0, description="time in which its amplitude grows after start_s and falls before end_s"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_end(self.start_s, self.end_s)
        if self.end_s is not None and self.end_s - self.start_s < 2 * self.rise_s:
            raise ValueError(
                f"rise_s {self.rise_s:g}: the ray grows and falls for longer than it is there, "
                f"{self.end_s - self.start_s:g} s; make it shorter"
            )
        return self

    def shortest_m(self, duration_s: float) -> float:
        """Extra path at its end or at that of the recording, if it shrinks."""
        end_s = duration_s if self.end_s is None else self.end_s
        return self.delay_m + min(0.0, self.delay_rate_m_s) * (end_s - self.start_s)


class Multipath(Attack):
    """Reflections of all signals of some satellites; no attack."""

    role: ClassVar[str] = "multipath"
    hostile: ClassVar[bool] = False

    kind: Literal["multipath"] = Field("multipath", description="no attack, but looks like one")
    ray: tuple[Ray, ...] = Field(min_length=1, description="reflections, [[attack.ray]]")

    def check(self, satellites: Sequence[Satellite], duration_s: float) -> None:
        """Also that no ray overtakes the direct signal."""
        super().check(satellites, duration_s)
        for number, ray in enumerate(self.ray, 1):
            shortest = ray.shortest_m(duration_s)
            if shortest < 0:
                raise ValueError(
                    f"ray (number {number}) delay_rate_m_s: the extra path shrinks to "
                    f"{shortest:g} m; give an end_s, a larger delay_m or a slower rate"
                )

    def starts(self) -> dict[str, float]:
        """Times at which the rays come."""
        return {f"ray (number {k}) start_s": r.start_s for k, r in enumerate(self.ray, 1)}

    def emissions(self, target: Target, draw: Draw) -> list[Emission]:
        """One emitter for each ray."""
        name = (target.satellite.system, target.satellite.prn)
        return [
            _emission(ray, target.spec.carrier_hz, draw("ray", *name, number))
            for number, ray in enumerate(self.ray)
        ]

    def timeline(self, satellite: Satellite, signals: tuple[str, ...]) -> dict[str, Any]:
        """Times of the first to come and the last to go; the rays as in the file."""
        del satellite, signals
        ends = [r.end_s for r in self.ray]
        return {
            "start_s": min(r.start_s for r in self.ray),
            "end_s": None if None in ends else max(e for e in ends if e is not None),
            "rays": [r.model_dump() for r in self.ray],
        }


def _emission(ray: Ray, carrier_hz: float, random: float) -> Emission:
    turn = ray.delay_rate_m_s * -carrier_hz / SPEED_OF_LIGHT + ray.phase_rate_hz
    start_s = ray.start_s
    phase = ray.phase_cycles
    if phase == "random":
        phase = random - math.fmod(ray.delay_m * carrier_hz / SPEED_OF_LIGHT, 1.0)
    return Emission(
        start_s=start_s,
        end_s=ray.end_s,
        power_db=_power_db(ray),
        code_offset_m=integrated([(start_s, 0.0), (start_s, ray.delay_rate_m_s)], ray.delay_m),
        carrier_offset_hz=[(start_s, 0.0), (start_s, turn)],
        phase_cycles=phase,
    )


def _power_db(ray: Ray) -> Knots:
    """Raised cosine in amplitude while it comes and goes."""
    full_db = 20 * math.log10(ray.ratio)
    if not ray.rise_s:
        return [(ray.start_s, full_db)]
    into = np.linspace(0.0, 1.0, _PIECES + 1)
    shape_db = 20 * np.log10(np.maximum(0.5 - 0.5 * np.cos(np.pi * into), _FLOOR))
    rise = zip(into * ray.rise_s, shape_db, strict=True)
    knots = [(ray.start_s + float(t), full_db + float(v)) for t, v in rise]
    if ray.end_s is not None:
        knots += [(ray.end_s - (t - ray.start_s), v) for t, v in reversed(knots)]
    return knots
