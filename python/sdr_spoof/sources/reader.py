"""What a file format must provide to be a source."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from datetime import datetime
    from pathlib import Path


@dataclass(frozen=True)
class Description:
    """What a file says of itself."""

    data: Path
    """File that holds the samples."""
    origin: str
    """Where the values come from, for messages."""
    values: dict[str, Any]
    """Fields of :class:`~sdr_spoof.sources.RecordingFormat` that the file tells."""
    table: str | None = None
    """TOML table that holds them, for messages."""
    hint: str = ""
    """How to give the values that the file does not tell."""
    extra: dict[str, Any] = field(default_factory=dict)
    start: datetime | None = None
    """UTC of the first sample, where the file tells it."""


@dataclass(frozen=True)
class Reader:
    """One source format: a line in the registry of ``sources/__init__.py``."""

    name: str
    matches: Callable[[Path], bool]
    describe: Callable[[Path], Description]
