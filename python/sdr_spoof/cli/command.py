"""What a command is, and its result as JSON and as text."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from datetime import datetime
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable

    from rich.console import Console

    from .ui import Ui

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells report it."""


@dataclass(frozen=True)
class Outcome:
    """Result of a command."""

    data: dict[str, Any]
    """The JSON object of ``--json``; see :func:`to_plain` for what it may hold."""
    render: Callable[[Console], None]
    """Prints the same for people."""
    exit_code: int = 0


@dataclass(frozen=True)
class Command:
    """One line of ``sdr-spoof --help``."""

    name: str
    summary: str
    configure: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace, Ui], Outcome]
    usage: str
    """Its arguments in one line; the help lists all of them."""
    details: str
    """A sentence or two on what it does and writes."""
    examples: tuple[str, ...]


def to_plain(value: Any) -> Any:
    """JSON-ready copy of dataclasses, pydantic models, numpy values, paths, times and containers.

    NaN and infinities become null, which JSON can hold.
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: to_plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, BaseModel):
        return to_plain(value.model_dump())
    if isinstance(value, dict):
        return {str(k): to_plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [to_plain(v) for v in value]
    return _plain_leaf(value)


def _plain_leaf(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return to_plain(value.tolist())
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, Path | datetime):
        return str(value)
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
