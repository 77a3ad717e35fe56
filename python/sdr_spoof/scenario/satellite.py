"""An authentic satellite: table ``[[satellite]]`` of a scenario."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, Self

from pydantic import BaseModel, Field, model_validator

from sdr_spoof.signals import components, signal_spec

from .base import FROZEN, REFERENCE_HZ, SPEED_OF_LIGHT, Phase
from .draw import uniform
from .motion import Motion

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.signals import SignalSpec


class Satellite(BaseModel):
    """An authentic satellite: one ``[[satellite]]``."""

    model_config = FROZEN

    prn: int = Field(description="PRN")
    system: str = Field("C", description="RINEX system letter")
    signals: tuple[str, ...] = Field(
        ("B1I", "B1C"), min_length=1, description="signals, e.g. B1C (data and pilot) or B1CP"
    )
    cn0_dbhz: float | dict[str, float] = Field(
        45.0, description="C/N0 of each signal (of all its components together), or one per signal"
    )
    range_rate_m_s: float | None = Field(None, description="range rate at 0 s; positive: receding")
    doppler_hz: float | None = Field(
        None, description="instead of range_rate_m_s: Doppler at 1575.42 MHz at 0 s"
    )
    range_acceleration_m_s2: float = Field(0.0, description="rate of change of the range rate")
    delay_ms: float = Field(70.0, description="code delay at 0 s")
    carrier_phase_cycles: Phase | Literal["geometric"] = Field(
        "geometric",
        description="carrier phase received at 0 s: a number, random, or geometric (that of a "
        "wave delayed by delay_ms, coherent between signals)",
    )
    data_seed: int | None = Field(
        None, ge=0, lt=2**63, description="seed of the data symbols (default: from the seed)"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_signals(self.system, self.prn, self.signals)
        if isinstance(self.cn0_dbhz, dict) and set(self.cn0_dbhz) != set(self.signals):
            raise ValueError(
                f"cn0_dbhz must name exactly the signals {', '.join(self.signals)}; it names "
                f"{', '.join(self.cn0_dbhz) or 'none'}"
            )
        range_rate(self.range_rate_m_s, self.doppler_hz)
        return self

    @property
    def range_rate(self) -> float:
        """Range rate at 0 s in m/s."""
        return range_rate(self.range_rate_m_s, self.doppler_hz)

    def signal_cn0_dbhz(self, signal: str) -> float:
        """C/N0 of one of its signals."""
        return self.cn0_dbhz[signal] if isinstance(self.cn0_dbhz, dict) else self.cn0_dbhz

    def motion(self, spec: SignalSpec, signal: str, seed: int) -> Motion:
        """How a component of one of its signals moves; the seed is that of the scenario."""
        per_m_s = -spec.carrier_hz / SPEED_OF_LIGHT
        return Motion(
            delay_s=self.delay_ms * 1e-3,
            phase_cycles=self._phase_cycles(spec, signal, seed),
            doppler_hz=self.range_rate * per_m_s,
            doppler_rate_hz_s=self.range_acceleration_m_s2 * per_m_s,
        )

    def symbols(self, spec: SignalSpec) -> NDArray[np.int8] | None:
        """Data symbols from code phase 0 on; None: pseudo-random ones."""
        del spec
        return None

    def _phase_cycles(self, spec: SignalSpec, signal: str, seed: int) -> float:
        """Received phase at 0 s, the same for all components of a signal."""
        if self.carrier_phase_cycles == "geometric":
            return -math.fmod(spec.carrier_hz * self.delay_ms * 1e-3, 1.0)
        if self.carrier_phase_cycles == "random":
            return uniform("phase", seed, self.system, self.prn, signal)
        return self.carrier_phase_cycles


def range_rate(range_rate_m_s: float | None, doppler_hz: float | None) -> float:
    """Range rate in m/s from the one of two keys that is given.

    Raises:
        ValueError: both are given, or it is out of bounds.
    """
    if range_rate_m_s is not None and doppler_hz is not None:
        raise ValueError("range_rate_m_s and doppler_hz say the same; give one of them")
    rate = range_rate_m_s or 0.0
    if doppler_hz is not None:
        rate = -doppler_hz * SPEED_OF_LIGHT / REFERENCE_HZ
    if abs(rate) > 1e5:
        raise ValueError("the range rate is over 100 km/s; check range_rate_m_s or doppler_hz")
    return rate


def check_signals(system: str, prn: int, signals: tuple[str, ...]) -> None:
    """Raise ValueError, naming the key, if a satellite does not send one of the signals."""
    if len(set(signals)) < len(signals):
        raise ValueError("signals names a signal twice")
    for signal in signals:
        for component in components(signal):
            spec = signal_spec(component)
            if spec.system != system:
                raise ValueError(
                    f"signals: {signal} belongs to system '{spec.system}', not '{system}'"
                )
            if prn not in spec.prns:
                raise ValueError(
                    f"prn: {system}{prn:02} does not transmit {signal}; PRNs that do: "
                    f"{_ranges(spec.prns)}"
                )


def _ranges(numbers: tuple[int, ...]) -> str:
    """``(1, 2, 3, 7)`` -> ``1-3, 7``."""
    starts = [n for n in numbers if n - 1 not in numbers]
    ends = [n for n in numbers if n + 1 not in numbers]
    return ", ".join(f"{a}-{b}" if a != b else f"{a}" for a, b in zip(starts, ends, strict=True))
