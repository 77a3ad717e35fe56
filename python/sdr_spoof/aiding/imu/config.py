"""How an IMU is mounted, and how its file is to be read: table ``[imu]``."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from .axes import checked

Axes = Annotated[str, AfterValidator(checked)]


class ImuConfig(BaseModel):
    """Settings of an IMU."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    format: str | None = Field(
        None, description="format of the file: csv, novatel (default: by what is in it)"
    )
    axes: Axes | None = Field(
        None,
        description="where x, y, z of the IMU point on the vehicle: FRD is forward, right, down "
        "(default: FRD; RFU for novatel)",
    )
    lever_arm_m: tuple[float, float, float] = Field(
        (0.0, 0.0, 0.0),
        description="antenna from the IMU: forward, right, down (default: as its file tells, or 0)",
    )
    start: str | None = Field(
        None,
        description="what time_s of a CSV file counts from: a date in UTC, 'GPS week seconds', or "
        "'BDT week seconds'",
    )
    clock_offset_s: float = Field(
        0.0, description="time by the IMU's clock less GNSS time; it is taken off"
    )
    model: str | None = Field(
        None, description="model of the IMU, for the scale factors of a NovAtel log without it"
    )
    checks: bool = Field(
        True, description="refuse units and axes that gravity and motion contradict"
    )
