"""What every reader of IMU files gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.errors import InertialError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from ..config import ImuConfig
    from ..rows import ImuRows


@dataclass(frozen=True)
class Reader:
    """A format of IMU files."""

    name: str
    """As in ``format`` of the configuration."""
    title: str
    axes: str
    """Usual mounting: see :mod:`..axes`."""
    matches: Callable[[str], bool]
    """Whether a file that begins with this text is one."""
    read: Callable[[Path, ImuConfig], ImuRows]
    """The rows in the IMU's own axes.

    Raises :class:`.InertialError` with the file's name and what to do.
    """


def text_of(path: Path) -> str:
    """All of a text file.

    Raises:
        InertialError: it cannot be read, or is not text.
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InertialError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InertialError(
            f"{path}: is not text; of binary logs, give the ASCII form that tools of their maker "
            "write"
        ) from error
