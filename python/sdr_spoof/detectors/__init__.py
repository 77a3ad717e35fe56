"""Detection: placeholder of the configuration until the stage is merged."""

from pydantic import BaseModel, ConfigDict


class DetectionConfig(BaseModel):
    """Settings of the detectors."""

    model_config = ConfigDict(frozen=True, extra="forbid")
