"""Induced capture: a replica creeps up in code, gains power, takes the loops and drags them away.

The takeover ``seamless`` is that of TEXBAT ds7 (T. E. Humphreys, "TEXBAT Data Sets 7 and 8",
University of Texas at Austin, 2016, section 4): the spoofer's phase phi against the authentic
carrier grows evenly and its amplitude ratio is -2 cos(phi), so that the sum 1 - 2 cos(phi)
exp(j phi) = -exp(2 j phi) keeps the authentic amplitude while its phase turns by half a cycle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from sdr_spoof.scenario.base import NonNegative, Phase

from .base import Emission, OnAir, Target
from .induced_profiles import (
    capture_time_s,
    carrier_offset_hz,
    code_offset_m,
    full_drag_offset_hz,
    phase_at_zero,
    power_db,
)

if TYPE_CHECKING:
    from sdr_spoof.scenario.draw import Draw
    from sdr_spoof.scenario.satellite import Satellite


class InducedAttack(OnAir):
    """Induced capture of signals of some satellites.

    From ``start_s`` the spoofer's replica approaches the authentic code for ``approach_s`` at the
    power ``power_start_db``; then it is aligned. Its power ramps to ``power_db`` in
    ``power_ramp_s``, holds, and from ``drag_start_s`` it drags the code away, the drag rate growing
    for ``drag_ramp_s`` and, from ``drag_end_s``, falling for as long.
    """

    role: ClassVar[str] = "spoof"

    kind: Literal["induced"] = Field("induced", description="kind of attack")
    prns: tuple[int, ...] = Field(
        min_length=1, description="attacked satellites of the scenario; prn = N does for one"
    )
    system: str = Field("C", description="RINEX system letter")
    signals: tuple[str, ...] = Field(min_length=1, description="attacked signals, e.g. B1C")
    approach_offset_m: float = Field(0.0, description="code offset at start_s")
    approach_s: NonNegative = Field(0.0, description="time to bring the code offset to zero")
    power_start_db: float = Field(-20.0, description="power against the authentic, at first")
    power_db: float | None = Field(
        None, description="power against the authentic, after the ramp (default 3.5)"
    )
    eta: float | None = Field(
        None, gt=0, description="instead of power_db: amplitude over the authentic one"
    )
    power_ramp_s: NonNegative = Field(2.0, description="length of the power ramp")
    takeover: Literal["ramp", "seamless"] = Field(
        "ramp",
        description="ramp: power grows evenly in dB; seamless: amplitude and phase grow so that "
        "the sum keeps the authentic amplitude, up to eta = 2 in antiphase",
    )
    drag_start_s: NonNegative | None = Field(None, description="start of the drag (default: none)")
    drag_rate_m_s: float = Field(0.0, description="final drag rate; positive: later code")
    drag_ramp_s: NonNegative = Field(1.0, description="time for the drag rate to grow from zero")
    drag_end_s: NonNegative | None = Field(
        None, description="the drag rate falls to zero from here, for drag_ramp_s (default: never)"
    )
    drag_eta: float | None = Field(
        None,
        gt=0,
        description="amplitude ratio to which eta moves in proportion to the dragged offset, "
        "reached at one chip (default: eta stays)",
    )
    carrier: Literal["coherent", "frequency-locked"] = Field(
        "coherent",
        description="coherent: the carrier moves with the code, f_e = -v/lambda; "
        "frequency-locked: only the code moves",
    )
    carrier_offset_hz: float = Field(0.0, description="constant carrier offset, added")
    carrier_phase_cycles: Phase | Literal["aligned", "antipodal"] = Field(
        "random",
        description="carrier phase against the authentic when the code is aligned (end of the "
        "approach): a number, aligned (0), antipodal (0.5) or random for each signal",
    )
    data: Literal["same", "delayed", "guessed"] = Field(
        "same",
        description="data symbols: the authentic ones, these late by data_delay_ms against the "
        "code, or with errors",
    )
    data_delay_ms: float | None = Field(None, gt=0, description="delay of delayed data")
    data_error_rate: float | None = Field(
        None, ge=0, le=1, description="share of wrong symbols of guessed data (default 0.5)"
    )
    data_known_s: NonNegative | None = Field(
        None, description="guessed data are right from here on (default: never)"
    )

    @property
    def ramp_start_s(self) -> float:
        """Start of the power ramp: the code is aligned."""
        return self.start_s + self.approach_s

    @property
    def ramp_end_s(self) -> float:
        """End of the power ramp."""
        return self.ramp_start_s + self.power_ramp_s

    @property
    def final_power_db(self) -> float:
        """Power after the ramp, from ``power_db`` or ``eta``."""
        if self.eta is not None:
            return 20 * math.log10(self.eta)
        return 3.5 if self.power_db is None else self.power_db

    @property
    def final_eta(self) -> float:
        """Amplitude ratio after the ramp."""
        return float(10 ** (self.final_power_db / 20))

    @model_validator(mode="after")
    def _times_are_in_order(self) -> Self:
        if self.approach_offset_m and not self.approach_s:
            raise ValueError("approach_offset_m needs approach_s, the time of the approach")
        start_s, end_s = self.drag_start_s, self.drag_end_s
        if start_s is None:
            for key in ("drag_rate_m_s", "drag_end_s", "drag_eta"):
                if getattr(self, key):
                    raise ValueError(f"{key} needs drag_start_s; add it or remove {key}")
        elif start_s < self.ramp_start_s:
            raise ValueError(
                f"drag_start_s {start_s:g} is before the end of the approach at "
                f"{self.ramp_start_s:g} s; make it later"
            )
        elif end_s is not None and end_s < start_s + self.drag_ramp_s:
            raise ValueError(
                f"drag_end_s {end_s:g} is before the drag has its full rate at "
                f"{start_s + self.drag_ramp_s:g} s; make it later or drag_ramp_s shorter"
            )
        return self

    @model_validator(mode="after")
    def _power_is_clear(self) -> Self:
        if self.power_db is not None and self.eta is not None:
            raise ValueError("power_db and eta say the same; give one of them")
        if self.takeover == "seamless":
            self._check_seamless()
        busy = self.takeover == "seamless" or self.drag_eta is not None
        if busy and self.drag_start_s is not None and self.drag_start_s < self.ramp_end_s:
            raise ValueError(
                f"drag_start_s {self.drag_start_s:g} is before the end of the power ramp at "
                f"{self.ramp_end_s:g} s, which neither takeover = 'seamless' nor drag_eta allows; "
                "make it later"
            )
        return self

    def _check_seamless(self) -> None:
        if not self.power_ramp_s:
            raise ValueError("takeover = 'seamless' needs a power_ramp_s above 0")
        if not self.power_start_db < self.final_power_db <= 20 * math.log10(2) + 1e-9:
            raise ValueError(
                "takeover = 'seamless' needs eta of at most 2 (power_db 6.02) and more than "
                f"power_start_db; it goes from {self.power_start_db:g} to "
                f"{self.final_power_db:g} dB"
            )
        if self.carrier_phase_cycles != "random" or self.carrier_offset_hz:
            raise ValueError(
                "takeover = 'seamless' sets the carrier phase itself; remove carrier_phase_cycles "
                "and carrier_offset_hz"
            )

    @model_validator(mode="after")
    def _data_are_clear(self) -> Self:
        if self.data == "delayed" and self.data_delay_ms is None:
            raise ValueError("data = 'delayed' needs data_delay_ms")
        if self.data != "delayed" and self.data_delay_ms is not None:
            raise ValueError("data_delay_ms needs data = 'delayed'")
        for key in ("data_error_rate", "data_known_s"):
            if self.data != "guessed" and getattr(self, key) is not None:
                raise ValueError(f"{key} needs data = 'guessed'")
        if self.data_known_s is not None and self.data_known_s <= self.start_s:
            raise ValueError(
                f"data_known_s {self.data_known_s:g} must be after start_s {self.start_s:g}"
            )
        return self

    def emissions(self, target: Target, draw: Draw) -> list[Emission]:
        """One emitter; two, one after the other, where guessed data become known."""
        satellite, spec = target.satellite, target.spec
        phase = draw(satellite.system, satellite.prn, target.signal)

        def emission(start_s: float, end_s: float | None, error_rate: float) -> Emission:
            return Emission(
                start_s=start_s,
                end_s=end_s,
                power_db=power_db(self, spec.chip_rate_hz),
                code_offset_m=code_offset_m(self),
                carrier_offset_hz=carrier_offset_hz(self, spec.carrier_hz),
                phase_cycles=phase_at_zero(self, spec.carrier_hz, phase),
                data_delay_s=(self.data_delay_ms or 0.0) * 1e-3,
                data_error_rate=error_rate,
            )

        if self.data != "guessed" or not target.has_data:
            return [emission(self.start_s, self.end_s, 0.0)]
        error_rate = 0.5 if self.data_error_rate is None else self.data_error_rate
        known_s = self.data_known_s
        if known_s is None or (self.end_s is not None and known_s >= self.end_s):
            return [emission(self.start_s, self.end_s, error_rate)]
        return [emission(self.start_s, known_s, error_rate), emission(known_s, self.end_s, 0.0)]

    def timeline(self, satellite: Satellite, signals: tuple[str, ...]) -> dict[str, Any]:
        """The first visible effect is near ``capture_s``."""
        del satellite
        start_s = self.drag_start_s
        return {
            "start_s": self.start_s,
            "alignment_s": self.ramp_start_s,
            "power_ramp_start_s": self.ramp_start_s,
            "power_ramp_end_s": self.ramp_end_s,
            "capture_s": capture_time_s(self),
            "drag_start_s": start_s,
            "drag_full_s": None if start_s is None else start_s + self.drag_ramp_s,
            "drag_end_s": self.drag_end_s,
            "end_s": self.end_s,
            "power_db": self.final_power_db,
            "eta": self.final_eta,
            "drag_rate_m_s": self.drag_rate_m_s,
            "carrier": self.carrier,
            "data": self.data,
            "carrier_offset_hz": full_drag_offset_hz(self, signals),
        }
