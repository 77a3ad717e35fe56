"""What kinds of receiver trajectory share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field

from sdr_spoof.scenario.base import FROZEN

if TYPE_CHECKING:
    from .trajectory import Trajectory

Latitude = Annotated[float, Field(ge=-90, le=90)]
Longitude = Annotated[float, Field(ge=-180, le=360)]
Vector = tuple[float, float, float]


class Receiver(BaseModel):
    """What all kinds share."""

    model_config = FROZEN

    kind: str = Field(description="kind of trajectory")
    lever_arm_m: Vector = Field(
        (0.0, 0.0, 0.0), description="antenna from the body's point: forward, right, down"
    )

    def trajectory(self, duration_s: float) -> Trajectory:
        """The motion for times from 0 to the duration, and a little more at either end.

        Raises:
            ValueError: it cannot be moved so; the message names the key.
        """
        raise NotImplementedError


class Placed(Receiver):
    """A trajectory about a place."""

    latitude_deg: Latitude = Field(description="latitude of the place, or of the middle")
    longitude_deg: Longitude = Field(description="its longitude")
    height_m: float = Field(0.0, description="its height above the ellipsoid")

    @property
    def origin(self) -> NDArray[np.float64]:
        """Latitude and longitude in degrees, height."""
        return np.array([self.latitude_deg, self.longitude_deg, self.height_m])


class Drawn(Placed):
    """A trajectory from a place, drawn by a seed."""

    latitude_deg: Latitude = Field(description="latitude at 0 s")
    longitude_deg: Longitude = Field(description="longitude at 0 s")
    seed: int = Field(0, ge=0, description="each seed is another way")
