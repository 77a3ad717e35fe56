"""What may be known beforehand of where and when a recording was made."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, field_validator


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

    @field_validator("place")
    @classmethod
    def _on_earth(cls, place: tuple[float, float, float] | None) -> object:
        if place is not None and not (abs(place[0]) <= 90 and abs(place[1]) <= 360):
            raise ValueError(f"latitude {place[0]:g}, longitude {place[1]:g} is no place on Earth")
        return place
