"""Acquisition: placeholder of the configuration until the stage is merged."""

from pydantic import BaseModel, ConfigDict


class AcquisitionConfig(BaseModel):
    """Settings of the FFT search."""

    model_config = ConfigDict(frozen=True, extra="forbid")
