"""The recording to make: table ``[recording]`` of a scenario."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from sdr_spoof.sources.model import SampledBand

from .agc import AgcTable, NoisePoint

_DEFAULT_RMS_LSB = {"i8": 16.0, "i16": 256.0, "f32": 1.0, "2": 2.0}


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
    noise: tuple[NoisePoint, ...] = Field((), description="how the noise rises and falls")
    agc: AgcTable | None = Field(None, description="automatic gain control; a fixed gain without")
    seed: int = Field(1, ge=0, lt=2**63, description="seed of the noise and of random choices")

    @model_validator(mode="after")
    def _filter_fits(self) -> Self:
        times = [point.time_s for point in self.noise]
        if times != sorted(times):
            raise ValueError("[[recording.noise]] time_s: the points must be in order of time")
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
