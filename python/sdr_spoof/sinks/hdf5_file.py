"""HDF5 files that may meet a full disk: HDF5 crashes the process where one of its writes fails."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import h5py

from sdr_spoof.raw_files import write_all

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from io import FileIO
    from pathlib import Path

_LIBVER = ("v110", "v110")
"""Fixed, so that a newer HDF5 library writes the same bytes."""


@contextmanager
def new_file(path: Path) -> Iterator[h5py.File]:
    """Make an HDF5 file, written to the disk as it grows.

    Raises:
        OSError: it cannot be written; what was made of it is of no use then.
    """
    with path.open("w+b", buffering=0) as disk:
        file = _NeverFailing(disk)
        try:
            with h5py.File(file, "w", libver=_LIBVER) as made:
                yield made
        except Exception:
            if file.failure is None:
                raise  # else HDF5 has missed what was not written
        if file.failure is not None:
            raise file.failure


class _NeverFailing:
    """Hides failures from HDF5: keeps the first, and drops everything from then on."""

    failure: OSError | None = None

    def __init__(self, disk: FileIO) -> None:
        self._disk = disk
        self.seek, self.tell, self.read = disk.seek, disk.tell, disk.read

    def write(self, content: bytearray) -> None:
        self._try(lambda: write_all(self._disk, content))

    def truncate(self, size: int) -> None:
        self._try(lambda: self._disk.truncate(size))

    def flush(self) -> None:
        """Nothing is buffered."""

    def _try(self, action: Callable[[], object]) -> None:
        if self.failure is None:
            try:
                action()
            except OSError as error:
                self.failure = error
