"""What must be known of a recording to read it."""

from __future__ import annotations

from typing import Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from sdr_spoof import _core


class SampledBand(BaseModel):
    """What samples are stored as, and what band of radio frequencies they hold."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    sample_format: str = Field(
        description="stored values: ri8 ci8 ri16 ci16 rf32 cf32 r2 c2 (r real, c complex I/Q, "
        "little endian; r2 and c2 are 2-bit sign and magnitude)"
    )
    sample_rate_hz: float = Field(gt=0, description="samples per second")
    lo_hz: float = Field(
        description="radio frequency that lies at 0 Hz in the file, so that file frequency = "
        "RF - lo_hz (for an IF recording: carrier minus IF)"
    )

    @field_validator("sample_format")
    @classmethod
    def _known_format(cls, name: str) -> str:
        _core.sample_format(name)  # its error lists the known names
        return name

    @property
    def bits_per_sample(self) -> int:
        """Bits of one sample, I and Q together."""
        return _core.sample_format(self.sample_format)[0]

    @property
    def is_complex(self) -> bool:
        """Whether samples are I/Q pairs."""
        return _core.sample_format(self.sample_format)[1]

    @property
    def band_hz(self) -> tuple[float, float]:
        """Lowest and highest radio frequency that the sampling can hold.

        A real recording holds file frequencies of one sign only; with ``lo_hz`` as given they
        are taken as positive.
        """
        half = self.sample_rate_hz / 2
        return (self.lo_hz - half if self.is_complex else self.lo_hz, self.lo_hz + half)


class RecordingFormat(SampledBand):
    """How samples are stored, and where the spectrum lies: file (IF) frequency = RF - lo_hz."""

    offset_bytes: int = Field(0, ge=0, description="bytes to skip at the start of the file")
    conjugate: bool = Field(
        False, description="true if the file holds I - jQ (spectrum mirrored); complex only"
    )
    bandwidth_hz: float | None = Field(
        None, gt=0, description="two-sided bandwidth of the front end; for information"
    )
    float_scale: float = Field(
        1.0,
        gt=0,
        description="rf32, cf32: factor before rounding to 16 bits (if left out: such that the "
        "rms over the start of the file becomes 30)",
    )
    gain_file: str | None = Field(
        None,
        description="CSV file with the gain of the recorder (columns time_s, gain_db), a path from "
        "the folder of the recording: powers are then those at the antenna",
    )

    @model_validator(mode="after")
    def _conjugate_needs_complex(self) -> Self:
        if self.conjugate and not self.is_complex:
            raise ValueError("conjugate needs a complex sample format")
        return self
