"""What all tables of a scenario share."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from sdr_spoof.signals import LIGHT_M_S

REFERENCE_HZ = 1575.42e6
"""Carrier at which Dopplers are stated that belong to no one signal."""
SPEED_OF_LIGHT = LIGHT_M_S

Phase = float | Literal["random"]
NonNegative = Annotated[float, Field(ge=0)]
FROZEN = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
