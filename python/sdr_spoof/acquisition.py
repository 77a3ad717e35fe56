"""Acquisition: placeholder of the interface until the stage is merged."""

from collections.abc import Sequence

from pydantic import BaseModel, ConfigDict

from .progress import Progress
from .records import Acquisition
from .sources import Recording


class AcquisitionConfig(BaseModel):
    """Settings of the FFT search."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def acquire(
    recording: Recording,
    config: AcquisitionConfig,
    *,
    signals: Sequence[str] | None = None,
    prns: Sequence[int] | None = None,
    start_sample: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> list[Acquisition]:
    """Search."""
    raise NotImplementedError
