"""What the stages need of a recording, whether it lies on a disk or is made as it is read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.gain import GainLog

    from .model import RecordingFormat


class Source(Protocol):
    """Samples with their format; :class:`~sdr_spoof.sources.Recording` is the usual one."""

    @property
    def path(self) -> Path:
        """Where it lies, or a name for it."""

    @property
    def format(self) -> RecordingFormat:
        """How samples are stored."""

    @property
    def gain(self) -> GainLog | None:
        """Gain of the recorder; None for a constant or unknown one."""

    @property
    def sample_count(self) -> int:
        """Whole samples."""

    def read_raw(self, start: int, count: int) -> NDArray[np.uint8]:
        """Bytes of ``count`` samples from ``start`` on, clipped at the end."""

    def check_signal(self, signal: str) -> None:
        """Raise SignalError if the recording cannot hold the signal."""

    def signals(self) -> list[str]:
        """Registry signals that it can hold."""
