"""Unbuffered files, which may read or write a part of what they are asked to."""

from __future__ import annotations

import errno
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from io import BytesIO, FileIO

    RawFile = FileIO | BytesIO
    """A file in memory serves as well."""


def read_all(file: RawFile, into: memoryview) -> None:
    """Fill a buffer.

    Raises:
        OSError: the disk fails, or the file ends before.
    """
    while into:
        count = file.readinto(into)
        if not count:
            raise OSError(errno.EIO, "it has become shorter since it was opened")
        into = into[count:]


def write_all(file: RawFile, content: bytes | bytearray) -> None:
    """Write the whole of a buffer.

    Raises:
        OSError: the disk fails, or is full.
    """
    rest = memoryview(content)
    while rest:
        rest = rest[file.write(rest) :]
