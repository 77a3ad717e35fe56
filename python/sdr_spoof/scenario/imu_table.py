"""The IMU beside the antenna: table ``[imu]`` of a scenario."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pydantic import BaseModel, Field, field_validator

from sdr_spoof.aiding.imu import grades
from sdr_spoof.aiding.imu.errors import ImuErrors, SensorErrors

from .base import FROZEN, NonNegative

Three = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]
_SLOWEST_HZ, _FASTEST_HZ = 50.0, 400.0


class _Sensor(BaseModel):
    """What is different from the grade, for three sensors of a kind."""

    model_config = FROZEN

    wander_s: float | None = Field(None, gt=0, description="correlation time of the wander")
    scale_ppm: Three | None = Field(None, description="scale factor errors")
    misalignment_mrad: Six | None = Field(
        None, description="what x reads of y and z, y of x and z, z of x and y"
    )

    def _given(self, **values: Any) -> dict[str, Any]:
        """Fields of the errors that are given here, in SI units."""
        ppm, mrad = self.scale_ppm, self.misalignment_mrad
        values |= {
            "wander_s": self.wander_s,
            "scale": None if ppm is None else tuple(v * 1e-6 for v in ppm),
            "misalignment_rad": None if mrad is None else tuple(v * 1e-3 for v in mrad),
        }
        return {name: value for name, value in values.items() if value is not None}


class Gyro(_Sensor):
    """``[imu.gyro]``."""

    bias_deg_h: Three | None = Field(None, description="constant biases of x, y, z")
    wander_deg_h: NonNegative | None = Field(None, description="size of the Gauss-Markov bias")
    random_walk_deg_rt_h: NonNegative | None = Field(None, description="angle random walk")
    range_deg_s: float | None = Field(None, gt=0, description="largest rate")
    step_arcsec: float | None = Field(None, gt=0, description="resolution of an increment")

    def on(self, errors: SensorErrors) -> SensorErrors:
        """A grade's errors with these instead."""
        given = self._given(
            bias=_times(self.bias_deg_h, grades.DEG_HOUR),
            wander=_time(self.wander_deg_h, grades.DEG_HOUR),
            density=_time(self.random_walk_deg_rt_h, grades.DEG_ROOT_HOUR),
            limit=_time(self.range_deg_s, grades.DEG_S),
            quantum=_time(self.step_arcsec, grades.DEG_HOUR),
        )
        return replace(errors, **given)


class Accelerometer(_Sensor):
    """``[imu.accelerometer]``."""

    bias_ug: Three | None = Field(None, description="constant biases of x, y, z")
    wander_ug: NonNegative | None = Field(None, description="size of the Gauss-Markov bias")
    random_walk_ug_rt_hz: NonNegative | None = Field(None, description="velocity random walk")
    range_g: float | None = Field(None, gt=0, description="largest specific force")
    step_mm_s: float | None = Field(None, gt=0, description="resolution of an increment")

    def on(self, errors: SensorErrors) -> SensorErrors:
        """A grade's errors with these instead."""
        given = self._given(
            bias=_times(self.bias_ug, grades.MICRO_G),
            wander=_time(self.wander_ug, grades.MICRO_G),
            density=_time(self.random_walk_ug_rt_hz, grades.MICRO_G),
            limit=_time(self.range_g, grades.GRAVITY_M_S2),
            quantum=_time(self.step_mm_s, 1e-3),
        )
        return replace(errors, **given)


class ImuTable(BaseModel):
    """An IMU at the body's point; the antenna is off it by ``lever_arm_m`` of the receiver."""

    model_config = FROZEN

    grade: str | None = Field(
        None,
        description=f"quality, of which its errors are drawn: {', '.join(grades.GRADES)} "
        "(default: perfect, but for what is given here)",
    )
    gyro: Gyro = Field(Gyro.model_validate({}), description="instead of the grade's")
    accelerometer: Accelerometer = Field(
        Accelerometer.model_validate({}), description="instead of the grade's"
    )
    rate_hz: float = Field(100.0, ge=_SLOWEST_HZ, le=_FASTEST_HZ, description="increments a second")
    start_s: NonNegative = Field(0.0, description="begins so long after the recording")
    still_s: NonNegative = Field(
        0.0,
        description="stands still, and is on, for so long before the recording: to be aligned; "
        "for a receiver that stands at 0 s",
    )
    clock_offset_s: float = Field(0.0, description="time by its clock less GNSS time")
    seed: int | None = Field(
        None, ge=0, lt=2**63, description="of its errors (default: that of the recording)"
    )

    @field_validator("grade")
    @classmethod
    def _known(cls, grade: str | None) -> str | None:
        if grade is not None and grade not in grades.GRADES:
            raise ValueError(f"unknown grade '{grade}'; known: {', '.join(grades.GRADES)}")
        return grade

    @field_validator("still_s")
    @classmethod
    def _one_beginning(cls, still_s: float, info: Any) -> float:
        if still_s and info.data.get("start_s"):
            raise ValueError("it cannot begin both before the recording and after its start_s")
        return still_s

    def errors(self, seed: int) -> ImuErrors:
        """Of this one IMU.

        Args:
            seed: The recording's.
        """
        own = seed if self.seed is None else self.seed
        drawn = ImuErrors(seed=own)
        if self.grade is not None:
            drawn = grades.one_run(grades.named(self.grade), own, 0)
        return replace(
            drawn,
            gyro=self.gyro.on(drawn.gyro),
            accelerometer=self.accelerometer.on(drawn.accelerometer),
        )


def _time(value: float | None, unit: float) -> float | None:
    return None if value is None else value * unit


def _times(values: Three | None, unit: float) -> Three | None:
    if values is None:
        return None
    x, y, z = values
    return x * unit, y * unit, z * unit
