"""Tracking: placeholder of the interface until the stage is merged."""

from collections.abc import Sequence

from pydantic import BaseModel, ConfigDict

from .progress import Progress
from .records import Acquisition, TrackLog
from .sources import Recording


class TrackingConfig(BaseModel):
    """Settings of the tracking loops."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def track(
    recording: Recording,
    acquisitions: Sequence[Acquisition],
    config: TrackingConfig,
    *,
    threads: int | None = None,
    block_s: float = 1.0,
    progress: Progress | None = None,
) -> TrackLog:
    """Track."""
    raise NotImplementedError
