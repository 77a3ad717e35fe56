"""How long-running functions report progress."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

Progress = Callable[[float, float], None]
"""Called as ``progress(done, total)``, in any unit."""

Stages = Callable[[str], AbstractContextManager[Progress | None]]
"""Opens the progress display of a named stage: ``with stages("Acquiring") as progress``."""


def silent(label: str) -> AbstractContextManager[Progress | None]:
    """Stages that show nothing."""
    return nullcontext()
