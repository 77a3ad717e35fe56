"""What may be known beforehand of where and when a recording was made."""

from __future__ import annotations

import math
from datetime import datetime
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, field_validator

COORDINATES = 3


class NavigationConfig(BaseModel):
    """Positioning, and what may help it."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    position: bool = Field(True, description="compute positions where the recording allows")
    files: tuple[Path, ...] = Field(
        (), description="RINEX navigation files: what satellites send need not be waited for"
    )
    time: datetime | None = Field(
        None,
        description="UTC of the first sample, to a minute or so, such as 2023-03-12T08:00:00; "
        "unset = as the recording's metadata has it",
    )
    place: tuple[float, float, float] | None = Field(
        None,
        description="latitude and longitude in degrees and height in m, good to 100 km or so; with "
        "a time and a navigation file recordings of a second give a fix",
    )

    @field_validator("place", mode="before")
    @classmethod
    def _three_numbers(cls, place: object) -> object:
        if place is not None and not _numbers(place):
            given = ",".join(map(str, place)) if isinstance(place, list | tuple) else str(place)
            raise ValueError(
                f"'{given}' is no place: give latitude, longitude and height, such as 31.2,121.5,30"
            )
        return place

    @field_validator("place")
    @classmethod
    def _on_earth(cls, place: tuple[float, float, float] | None) -> object:
        if place is not None and not (abs(place[0]) <= 90 and abs(place[1]) <= 360):
            raise ValueError(f"latitude {place[0]:g}, longitude {place[1]:g} is no place on Earth")
        return place


def _numbers(values: object) -> bool:
    """Whether these are three numbers, or texts of such."""
    if not isinstance(values, list | tuple) or len(values) != COORDINATES:
        return False
    try:
        return all(math.isfinite(float(v)) for v in values)
    except (TypeError, ValueError):
        return False
