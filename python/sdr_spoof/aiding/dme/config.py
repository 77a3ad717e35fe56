"""Configuration of sequential tests against an INS and DME."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


class SequentialConfig(BaseModel):
    """Which rule, how often noise may raise an alarm, and what the noise is."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    rule: str = Field("glr-windows", description="Decision rule, by registry name.")
    false_alarms_per_hour: float = Field(
        0.01,
        gt=0.0,
        le=0.5,
        description="Probability per hour that noise raises an alarm of all tests together.",
    )
    sigma_m: float | None = Field(
        None,
        gt=0.0,
        description="Noise of a pseudorange in m (default: as measured in the first baseline_s).",
    )
    baseline_s: float = Field(
        60.0,
        ge=20.0,
        description="Signal before the tests, from which noise and its memory are measured, in s.",
    )
    isolation_s: float = Field(
        30.0, gt=0.0, description="Signal before the end that isolation averages, at most, in s."
    )
    dme_clock_s: float = Field(
        0.5, gt=0.0, description="A DME range counts for epochs at most this far away, in s."
    )
    ins_grade: str | None = Field(
        None,
        description="Quality of a free INS, by name (as rate-grade): its drift is learnt, and only "
        "what it cannot explain counts (default: places of the INS are exact).",
    )
    ins_aligned_s: float = Field(
        0.0, ge=0.0, description="Time from that INS's alignment to the first epoch, in s."
    )
