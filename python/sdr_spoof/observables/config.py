"""Settings of the observables."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class ObservablesConfig(BaseModel):
    """How pseudorange, phase and Doppler are read from the tracks."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    rate_hz: int = Field(
        1, ge=1, le=50, description="epochs per second, at whole multiples of receiver time"
    )
    code: Literal["loop", "measured"] = Field(
        "loop",
        description="code phase to use: that of the code loop's oscillator, with the noise of its "
        "bandwidth; or the discriminator's too, with ten times the noise but none of its memory",
    )
    window_s: float = Field(
        0.1,
        gt=0,
        le=1,
        description="rows to which a parabola is fitted around an epoch; 0.1 s has about the "
        "noise bandwidth of a 10 Hz phase loop, without its lag",
    )
    subcarrier_window_s: float = Field(
        0.5, gt=0, le=5, description="the same for the pseudorange of a combo's subcarrier"
    )
    smoothing_s: float = Field(
        0.0,
        ge=0,
        le=100,
        description="time constant with which the carrier smooths the code (0: not at all)",
    )
    trust_fallback: bool = Field(
        False,
        description="of a spoofed satellite, trust the signal that its verdict calls unharmed",
    )
