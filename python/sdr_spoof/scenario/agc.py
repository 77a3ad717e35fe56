"""Tables ``[[recording.noise]]`` and ``[recording.agc]``: the end of a recorder's front end."""

from __future__ import annotations

from typing import Self

from pydantic import BaseModel, Field, model_validator

from .base import FROZEN


class NoisePoint(BaseModel):
    """One of ``[[recording.noise]]``."""

    model_config = FROZEN

    time_s: float = Field(description="when")
    rise_db: float = Field(
        ge=-30,
        le=60,
        description="noise over its nominal density: interference as wide as the "
        "band; a straight line in dB to the next point, constant before the first and after the "
        "last",
    )


class AgcTable(BaseModel):
    """Table ``[recording.agc]``: the gain follows the power at the quantiser's input."""

    model_config = FROZEN

    time_constant_s: float = Field(
        0.1, gt=0, description="in which a step of the power is followed to 1 - 1/e, in dB"
    )
    update_s: float = Field(
        0.001, gt=0, description="the gain is set so often, constant in between"
    )
    min_gain_db: float = Field(
        -60.0, description="least gain; at 0 dB the noise alone has its nominal level"
    )
    max_gain_db: float = Field(20.0, description="largest gain")

    @model_validator(mode="after")
    def _ascends(self) -> Self:
        if self.min_gain_db > self.max_gain_db:
            raise ValueError(
                f"min_gain_db {self.min_gain_db:g} is above max_gain_db {self.max_gain_db:g}; "
                "exchange them"
            )
        return self
