"""How the phases of an array are tested: table ``[array]`` of the configuration."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

Form = Literal["pair", "all", "slope", "matched"]
"""See :mod:`.motion`."""


class ArrayConfig(BaseModel):
    """How an array's phases are tested."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    form: Form = Field("matched", description="test: pair, all, slope or matched")
    false_alarm_probability: float = Field(
        1e-3, gt=0, lt=0.5, description="of the whole recording, all satellites together"
    )
    test_every_m: float = Field(10.0, gt=0, description="way between two tests of a satellite")
    least_way_m: float = Field(20.0, gt=0, description="way below which nothing is tested")
    most_epochs: int = Field(20, ge=2, le=200, description="epochs of a test, spread evenly")
    yaw_sigma_deg: float = Field(
        0.5, ge=0, description="error of the INS's yaw since an earlier epoch"
    )
    heading_sigma_deg: float = Field(
        0.5, ge=0, description="error of the INS's yaw itself, for directions of arrival"
    )
    line_sigma_cycles: float = Field(
        0.0, ge=0, description="unknown constant delay of each antenna's line"
    )
