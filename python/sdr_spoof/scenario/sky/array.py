"""An array of antennas on the receiver's body: table ``[sky.array]``."""

from __future__ import annotations

from typing import Self

from pydantic import BaseModel, Field, model_validator

from sdr_spoof.aiding.array.geometry import array_of
from sdr_spoof.scenario.base import FROZEN

Vector = tuple[float, float, float]


class ArrayTable(BaseModel):
    """Antennas with one common clock, each of which gives a recording of its own."""

    model_config = FROZEN

    elements_m: tuple[Vector, ...] = Field(
        min_length=3,
        description="places of the antennas: forward, right, down from the end of the receiver's "
        "lever arm; the first is the reference",
    )
    line_cycles: tuple[float, ...] = Field(
        (), description="what each antenna's line adds to the carrier's phase (default: nothing)"
    )
    antenna: int | None = Field(
        None, ge=0, description="number of the one that is recorded (default: all of them)"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        try:
            array_of(self.elements_m)
        except ValueError as error:
            raise ValueError(f"elements_m: {error}") from error
        count = len(self.elements_m)
        if self.line_cycles and len(self.line_cycles) != count:
            raise ValueError(f"line_cycles: give one for each of the {count} antennas")
        if self.antenna is not None and self.antenna >= count:
            raise ValueError(f"antenna: there are {count}, numbered from 0")
        return self

    @property
    def place_m(self) -> Vector:
        """Of the antenna that is recorded."""
        return self.elements_m[self.antenna or 0]

    @property
    def delay_cycles(self) -> float:
        """Of the line of the antenna that is recorded."""
        return self.line_cycles[self.antenna or 0] if self.line_cycles else 0.0
