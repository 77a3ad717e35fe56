"""Asynchronous generation: counterfeit signals that know nothing of the authentic ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from sdr_spoof.scenario.base import REFERENCE_HZ, SPEED_OF_LIGHT, NonNegative
from sdr_spoof.scenario.satellite import Satellite, range_rate

from .base import Emission, OnAir, Target, Victims

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.scenario.draw import Draw

_RANDOM_DELAY_MS = (60.0, 90.0)
_RANDOM_DOPPLER_HZ = (-4000.0, 4000.0)


class Asynchronous(OnAir):
    """Signals in the name of some satellites, at any delay, Doppler and power, with other data.

    The satellites need not be in the scenario. Carriers and codes of one of them are coherent.
    """

    role: ClassVar[str] = "spoof"

    kind: Literal["asynchronous"] = Field("asynchronous", description="kind of attack")
    prns: tuple[int, ...] = Field(
        min_length=1, description="satellites to imitate; prn = N does for one"
    )
    system: str = Field("C", description="RINEX system letter")
    signals: tuple[str, ...] = Field(min_length=1, description="signals, e.g. B1C")
    cn0_dbhz: float = Field(
        55.0, description="C/N0 of each signal (of all its components together)"
    )
    cn0_start_dbhz: float | None = Field(
        None, description="C/N0 at start_s, from which it rises (default: cn0_dbhz)"
    )
    power_ramp_s: NonNegative = Field(0.0, description="time in which the power rises")
    delay_ms: float | Literal["random"] = Field(
        "random", description="code delay at 0 s: a number, or random from 60 to 90 per satellite"
    )
    range_rate_m_s: float | None = Field(None, description="range rate at 0 s; positive: receding")
    doppler_hz: float | Literal["random"] | None = Field(
        None,
        description="instead of range_rate_m_s: Doppler at 1575.42 MHz at 0 s; random: within "
        "4 kHz, per satellite (default)",
    )
    range_acceleration_m_s2: float = Field(0.0, description="rate of change of the range rate")
    carrier_phase_cycles: float | Literal["geometric", "random"] = Field(
        "geometric",
        description="carrier phase at 0 s: a number, geometric (that of delay_ms), or random for "
        "each signal",
    )
    data_seed: int | None = Field(
        None, ge=0, lt=2**63, description="seed of its data symbols (default: from the seed)"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        range_rate(self.range_rate_m_s, 0.0 if self.doppler_hz == "random" else self.doppler_hz)
        if self.cn0_start_dbhz is not None and not self.power_ramp_s:
            raise ValueError("cn0_start_dbhz needs power_ramp_s, the time of the rise")
        if self.power_ramp_s and self.cn0_start_dbhz is None:
            raise ValueError("power_ramp_s needs cn0_start_dbhz, the C/N0 at start_s")
        return self

    def victims(self, satellites: Sequence[Satellite], draw: Draw) -> Victims:
        """Satellites of its own, which move as the keys say."""
        del satellites
        return [(self._counterfeit(prn, draw), self.signals) for prn in self.prns]

    def check(self, satellites: Sequence[Satellite], duration_s: float) -> None:
        """Any satellite can be imitated."""
        del satellites
        self.check_starts(duration_s)

    def emissions(self, target: Target, draw: Draw) -> list[Emission]:
        """The counterfeit satellite's component as it is."""
        random = self.carrier_phase_cycles == "random"
        power = []
        if self.cn0_start_dbhz is not None:
            end_s = self.start_s + self.power_ramp_s
            power = [(self.start_s, self.cn0_start_dbhz - self.cn0_dbhz), (end_s, 0.0)]
        return [
            Emission(
                start_s=self.start_s,
                end_s=self.end_s,
                power_db=power,
                phase_cycles=draw("phase", target.satellite.prn, target.signal) if random else 0.0,
            )
        ]

    def timeline(self, satellite: Satellite, signals: tuple[str, ...]) -> dict[str, Any]:
        """Times, and how the counterfeit satellite moves."""
        del signals
        return {
            "start_s": self.start_s,
            "end_s": self.end_s,
            "cn0_dbhz": self.cn0_dbhz,
            "delay_ms": satellite.delay_ms,
            "range_rate_m_s": satellite.range_rate,
        }

    def _counterfeit(self, prn: int, draw: Draw) -> Satellite:
        data_seed = int(draw("data", prn) * 2**52) if self.data_seed is None else self.data_seed
        phase = self.carrier_phase_cycles
        delay_ms, rate = self.delay_ms, self.range_rate_m_s
        if delay_ms == "random":
            delay_ms = _between(_RANDOM_DELAY_MS, draw("delay", prn))
        if rate is None:
            doppler_hz = self.doppler_hz
            if doppler_hz is None or doppler_hz == "random":
                doppler_hz = _between(_RANDOM_DOPPLER_HZ, draw("doppler", prn))
            rate = -doppler_hz * SPEED_OF_LIGHT / REFERENCE_HZ
        return Satellite(
            prn=prn,
            system=self.system,
            signals=self.signals,
            cn0_dbhz=self.cn0_dbhz,
            range_rate_m_s=rate,
            range_acceleration_m_s2=self.range_acceleration_m_s2,
            delay_ms=delay_ms,
            carrier_phase_cycles=0.0 if phase == "random" else phase,
            data_seed=data_seed,
        )


def _between(limits: tuple[float, float], share: float) -> float:
    return limits[0] + (limits[1] - limits[0]) * share
