"""Files that appear whole or not at all, and never replace another by accident."""

from __future__ import annotations

import errno
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from sdr_spoof.errors import OutputError, SdrSpoofError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@contextmanager
def replacing(path: Path, *, force: bool = False) -> Iterator[Path]:
    """Yield a temporary path beside ``path``; rename it to ``path`` if the block succeeds.

    Raises:
        OutputError: ``path`` exists and ``force`` is not set, or writing fails (disk full).
    """
    if path.exists() and not force:
        raise OutputError(f"{path}: exists already; add --force to replace it")
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        temporary.replace(path)
    except SdrSpoofError:
        raise
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {reason(error)}") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_bytes(path: Path, content: bytes, *, force: bool = False) -> None:
    """Write a whole file.

    Raises:
        OutputError: as :func:`replacing`.
    """
    with replacing(path, force=force) as temporary:
        temporary.write_bytes(content)


def reason(error: OSError) -> str:
    """Why writing failed, and what to do."""
    if error.errno == errno.ENOSPC:
        return "no space left on the disk; free some, or write elsewhere"
    return error.strerror or str(error)
