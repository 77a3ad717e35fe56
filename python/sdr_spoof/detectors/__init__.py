"""Detection: placeholder of the interface until the stage is merged."""

from pydantic import BaseModel, ConfigDict

from sdr_spoof.records import TrackLog, Verdict


class DetectionConfig(BaseModel):
    """Settings of the detectors."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def detect(log: TrackLog, config: DetectionConfig) -> Verdict:
    """Detect."""
    raise NotImplementedError
