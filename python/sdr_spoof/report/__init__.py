"""Report: placeholder of the interface until the stage is merged."""

from typing import Any


def write_report(path: Any, *args: Any, **kwargs: Any) -> None:
    """Write."""
    raise NotImplementedError
