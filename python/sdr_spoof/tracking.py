"""Tracking: placeholder of the configuration until the stage is merged."""

from pydantic import BaseModel, ConfigDict


class TrackingConfig(BaseModel):
    """Settings of the tracking loops."""

    model_config = ConfigDict(frozen=True, extra="forbid")
