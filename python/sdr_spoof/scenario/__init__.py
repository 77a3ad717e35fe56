"""Scenario: placeholder of the interface until the stage is merged."""

from pathlib import Path
from typing import Any

from sdr_spoof.progress import Progress


def load_scenario(path: Path) -> Any:
    """Load."""
    raise NotImplementedError


def synthesize(
    scenario: Any,
    out: Path,
    *,
    threads: int | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Synthesise."""
    raise NotImplementedError
