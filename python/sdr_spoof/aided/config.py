"""Configuration of aided navigation as a whole: table ``[aided]``."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class AidedConfig(BaseModel):
    """Which tests run, what is stated, and what is known of the IMU."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    detectors: tuple[str, ...] = Field(
        ("rate_drag", "rate_local"),
        description="Tests of carrier-phase rates against the INS, by name: rate_drag, "
        "rate_local, rate_consistency, rate_satellites, position_consistency.",
    )
    grade: str = Field(
        "",
        description="Quality of the IMU, by name: navigation, tactical, industrial, mems, n1, n2, "
        "ship-a, ship-b; empty: what [tight] and [rate] say.",
    )
    oscillator: Literal["", "ideal", "TCXO", "poor-TCXO", "OCXO"] = Field(
        "TCXO", description="The receiver's oscillator; empty: what [tight] says of the clock."
    )
    attitude_deg: tuple[float, float, float] | None = Field(
        None,
        description="Yaw (from north to east), pitch and roll at the first epoch of GNSS, in "
        "degrees; none: found by alignment.",
    )
    align_s: float = Field(
        60.0, ge=5.0, description="At most so much of the beginning is used to align, in s."
    )
    integrity_risk: float = Field(
        1e-5,
        gt=0.0,
        lt=0.1,
        description="Probability that an error exceeds its protection level, if the satellites in "
        "use are right.",
    )
    min_tested_s: float = Field(
        10.0, gt=0.0, description="Less that could be tested is not enough support for 'clean'."
    )
