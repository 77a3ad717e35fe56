"""The results as they come: one line of JSON per run, appended and never changed.

A line is written with one call, so that a campaign that is killed leaves whole lines and at most
one torn one, which is cut off when the file is opened again.
"""

from __future__ import annotations

import fcntl
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from sdr_spoof.errors import OutputError
from sdr_spoof.raw_files import write_all
from sdr_spoof.sinks.atomic import reason

if TYPE_CHECKING:
    from collections.abc import Iterator
    from io import FileIO
    from pathlib import Path


@dataclass(frozen=True)
class Record:
    """One run that is done."""

    point: int
    run: int
    seed: int
    error: str
    """Empty, or why the run failed; it then has no values."""
    values: tuple[Any, ...]
    """One per column of the campaign."""

    def line(self) -> bytes:
        """As the journal holds it."""
        content = [self.point, self.run, self.seed, self.error, list(self.values)]
        return json.dumps(content, separators=(",", ":")).encode() + b"\n"

    @classmethod
    def parse(cls, line: bytes) -> Record | None:
        """Read a line; None if it is torn."""
        try:
            point, run, seed, error, values = json.loads(line)
        except ValueError:
            return None
        return cls(point, run, seed, error, tuple(values)) if line.endswith(b"\n") else None


class Journal:
    """The open journal of a campaign; no second process can open it meanwhile."""

    def __init__(self, path: Path) -> None:
        """Open or make the journal, and cut off a torn end.

        Raises:
            OutputError: it cannot be opened, or another process has it open.
        """
        self.path = path
        self.done: set[tuple[int, int]] = set()
        """(point, run) of every line."""
        self._file = _opened(path)
        end = 0
        for record, line in _lines(path):
            self.done.add((record.point, record.run))
            end += len(line)
        self._file.truncate(end)
        self._file.seek(end)

    def append(self, record: Record) -> None:
        """Write one run.

        Raises:
            OutputError: the disk is full or fails.
        """
        try:
            write_all(self._file, record.line())
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be written: {reason(error)}") from error
        self.done.add((record.point, record.run))

    def close(self) -> None:
        """Close it and let others open it."""
        self._file.close()

    def __enter__(self) -> Self:
        """Itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()


def read_journal(path: Path) -> Iterator[Record]:
    """Every whole line, in the order in which runs ended."""
    return (record for record, _ in _lines(path))


def _opened(path: Path) -> FileIO:
    try:
        path.touch()
        file = path.open("r+b", buffering=0)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {reason(error)}") from error
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        file.close()
        raise OutputError(
            f"{path}: another process is running this campaign; wait for it, or name another folder"
        ) from error
    return file


def _lines(path: Path) -> Iterator[tuple[Record, bytes]]:
    """Whole lines up to the first torn one."""
    with path.open("rb") as file:
        for line in file:
            record = Record.parse(line)
            if record is None:
                return
            yield record, line
