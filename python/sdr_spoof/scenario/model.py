"""What a scenario file says, checked. Times are seconds since the first sample."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from sdr_spoof.signals import components, signal_spec
from sdr_spoof.sources.model import SampledBand

REFERENCE_HZ = 1575.42e6
"""Carrier at which ``Satellite.doppler_hz`` is stated."""
SPEED_OF_LIGHT = 299_792_458.0

Phase = float | Literal["random"]
NonNegative = Annotated[float, Field(ge=0)]
_DEFAULT_RMS_LSB = {"i8": 16.0, "i16": 256.0, "f32": 1.0, "2": 2.0}
_CONFIG = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class RecordingPlan(SampledBand):
    """The recording to make: table ``[recording]``."""

    duration_s: float = Field(gt=0, description="length")
    sample_format: str = Field("ri8", description="ri8 ci8 ri16 ci16 rf32 cf32 r2 c2")
    bandwidth_hz: float | None = Field(
        None, gt=0, description="front-end bandwidth (6 dB); no filter if left out"
    )
    centre_hz: float | None = Field(
        None,
        description="radio frequency in the middle of the front-end band (default: middle "
        "of the sampled band)",
    )
    filter_taps: int = Field(63, ge=3, le=2001, description="taps of the filter, an odd number")
    noise_rms_lsb: float | None = Field(
        None,
        gt=0,
        description="rms of the recorded noise (of I and of Q) in output units; default 16 for "
        "int8, 256 for int16, 1 for float, 2 (the optimum) for 2-bit samples",
    )
    seed: int = Field(1, ge=0, lt=2**63, description="seed of the noise and of random choices")

    @model_validator(mode="after")
    def _filter_fits(self) -> Self:
        if self.filter_taps % 2 == 0:
            raise ValueError(f"filter_taps must be an odd number, not {self.filter_taps}")
        if self.bandwidth_hz is None:
            if self.centre_hz is not None:
                raise ValueError("centre_hz needs bandwidth_hz; add it or remove centre_hz")
            return self
        low, high = self.band_hz
        half = self.bandwidth_hz / 2
        if self.front_end_centre_hz - half < low or self.front_end_centre_hz + half > high:
            raise ValueError(
                f"bandwidth_hz {self.bandwidth_hz:g} around {self.front_end_centre_hz / 1e6:g} MHz "
                f"is not inside the sampled band {low / 1e6:g} to {high / 1e6:g} MHz; use a "
                "narrower filter, another centre_hz or a higher sample_rate_hz"
            )
        return self

    @property
    def front_end_centre_hz(self) -> float:
        """Middle of the front-end band."""
        return sum(self.band_hz) / 2 if self.centre_hz is None else self.centre_hz

    @property
    def rms_lsb(self) -> float:
        """Noise rms in output units, default resolved."""
        return self.noise_rms_lsb or _DEFAULT_RMS_LSB[self.sample_format[1:]]

    @property
    def sample_count(self) -> int:
        """Samples in the recording: a whole number of bytes."""
        return round(self.duration_s * self.sample_rate_hz) // 4 * 4


class Satellite(BaseModel):
    """An authentic satellite: one ``[[satellite]]``."""

    model_config = _CONFIG

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
        _check_signals(self.system, self.prn, self.signals)
        if self.range_rate_m_s is not None and self.doppler_hz is not None:
            raise ValueError("range_rate_m_s and doppler_hz say the same; give one of them")
        if isinstance(self.cn0_dbhz, dict) and set(self.cn0_dbhz) != set(self.signals):
            raise ValueError(
                f"cn0_dbhz must name exactly the signals {', '.join(self.signals)}; it names "
                f"{', '.join(self.cn0_dbhz) or 'none'}"
            )
        if abs(self.range_rate) > 1e5:
            raise ValueError("the range rate is over 100 km/s; check range_rate_m_s or doppler_hz")
        return self

    @property
    def range_rate(self) -> float:
        """Range rate at 0 s in m/s."""
        if self.doppler_hz is not None:
            return -self.doppler_hz * SPEED_OF_LIGHT / REFERENCE_HZ
        return self.range_rate_m_s or 0.0

    def signal_cn0_dbhz(self, signal: str) -> float:
        """C/N0 of one of its signals."""
        return self.cn0_dbhz[signal] if isinstance(self.cn0_dbhz, dict) else self.cn0_dbhz


class InducedAttack(BaseModel):
    """Induced capture of some signals of one satellite: one ``[[attack]]``.

    From ``start_s`` the spoofer's replica approaches the authentic code for ``approach_s`` at the
    power ``power_start_db``, then its power ramps to ``power_db`` in ``power_ramp_s``, holds, and
    from ``drag_start_s`` it drags the code away, the drag rate growing for ``drag_ramp_s``.
    """

    model_config = _CONFIG

    kind: Literal["induced"] = Field("induced", description="kind of attack")
    prn: int = Field(description="attacked satellite; it must be in the scenario")
    system: str = Field("C", description="RINEX system letter")
    signals: tuple[str, ...] = Field(min_length=1, description="attacked signals, e.g. B1C")
    start_s: NonNegative = Field(description="on the air from here")
    end_s: NonNegative | None = Field(None, description="off the air from here (default: the end)")
    approach_offset_m: float = Field(0.0, description="code offset at start_s")
    approach_s: NonNegative = Field(0.0, description="time to bring the code offset to zero")
    power_start_db: float = Field(-20.0, description="power against the authentic, at first")
    power_db: float = Field(3.5, description="power against the authentic, after the ramp")
    power_ramp_s: NonNegative = Field(2.0, description="length of the power ramp")
    drag_start_s: NonNegative | None = Field(None, description="start of the drag (default: none)")
    drag_rate_m_s: float = Field(0.0, description="final drag rate; positive: later code")
    drag_ramp_s: NonNegative = Field(1.0, description="time for the drag rate to grow from zero")
    carrier: Literal["coherent", "frequency-locked"] = Field(
        "coherent",
        description="coherent: the carrier moves with the code, f_e = -v/lambda; "
        "frequency-locked: only the code moves",
    )
    carrier_offset_hz: float = Field(0.0, description="constant carrier offset, added")
    carrier_phase_cycles: Phase = Field(
        "random", description="carrier phase against the authentic at start_s"
    )

    @property
    def ramp_start_s(self) -> float:
        """Start of the power ramp."""
        return self.start_s + self.approach_s

    @property
    def ramp_end_s(self) -> float:
        """End of the power ramp."""
        return self.ramp_start_s + self.power_ramp_s

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        _check_signals(self.system, self.prn, self.signals)
        if self.approach_offset_m and not self.approach_s:
            raise ValueError("approach_offset_m needs approach_s, the time of the approach")
        if self.drag_rate_m_s and self.drag_start_s is None:
            raise ValueError("drag_rate_m_s needs drag_start_s")
        if self.drag_start_s is not None and self.drag_start_s < self.ramp_start_s:
            raise ValueError(
                f"drag_start_s {self.drag_start_s:g} is before the end of the approach at "
                f"{self.ramp_start_s:g} s"
            )
        if self.end_s is not None and self.end_s <= self.start_s:
            raise ValueError(f"end_s {self.end_s:g} must be after start_s {self.start_s:g}")
        return self


class Scenario(BaseModel):
    """A whole scenario file."""

    model_config = _CONFIG

    title: str = Field("", description="what it shows")
    recording: RecordingPlan
    satellite: tuple[Satellite, ...] = Field((), description="authentic satellites")
    attack: tuple[InducedAttack, ...] = Field((), description="attacks")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        names = [(s.system, s.prn) for s in self.satellite]
        for system, prn in names:
            if names.count((system, prn)) > 1:
                raise ValueError(f"[[satellite]] prn: {system}{prn:02} appears twice")
        for satellite in self.satellite:
            for signal in satellite.signals:
                self._check_band(satellite, signal)
        for attack in self.attack:
            self._check_attack(attack)
        return self

    def _check_band(self, satellite: Satellite, signal: str) -> None:
        low, high = self.recording.band_hz
        for component in components(signal):
            spec = signal_spec(component)
            first = spec.carrier_hz - spec.min_half_bandwidth_hz
            last = spec.carrier_hz + spec.min_half_bandwidth_hz
            if first < low or last > high:
                raise ValueError(
                    f"[[satellite]] signals: {signal} of PRN {satellite.prn} needs {first / 1e6:g} "
                    f"to {last / 1e6:g} MHz; the recording samples {low / 1e6:g} to "
                    f"{high / 1e6:g} MHz: raise sample_rate_hz, move lo_hz, or leave {signal} out"
                )

    def _check_attack(self, attack: InducedAttack) -> None:
        target = self.target(attack)
        missing = [s for s in attack.signals if target is None or s not in target.signals]
        if missing:
            raise ValueError(
                f"[[attack]] prn: no [[satellite]] {attack.system}{attack.prn:02} with "
                f"{', '.join(missing)} to attack; add it or correct prn and signals"
            )
        if attack.start_s >= self.recording.duration_s:
            raise ValueError(
                f"[[attack]] start_s: {attack.start_s:g} is after the end of the recording at "
                f"{self.recording.duration_s:g} s"
            )

    def target(self, attack: InducedAttack) -> Satellite | None:
        """The satellite that an attack is against."""
        name = (attack.system, attack.prn)
        return next((s for s in self.satellite if (s.system, s.prn) == name), None)


def _check_signals(system: str, prn: int, signals: tuple[str, ...]) -> None:
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
