"""Rows of tracks while they are recorded: in memory, or in a temporary file.

24 signals give 0.4 MB of rows a second, without end. They come in small pieces; here they are
gathered column by column into blocks of equal length, and full blocks go to one file that all
tracks share. So a track holds one block in memory, however long it is, and a column is read back
in few, large steps.
"""

from __future__ import annotations

import io
import tempfile
import weakref
from array import array
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np

from .errors import OutputError
from .raw_files import read_all, write_all
from .records import ComboTrack, SignalTrack, Track
from .sinks.atomic import reason

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from io import FileIO
    from pathlib import Path
    from typing import Self

    from numpy.typing import NDArray

Kind = TypeVar("Kind", bound=Track)

BLOCK_EPOCHS = 1024
"""Rows of a block: 120 kB of a signal's."""


class RowStore:
    """Tracks that grow at the end."""

    def __init__(self, folder: Path | None = None) -> None:
        """Keep rows in a file without a name in ``folder``, or in memory if none is given.

        The file vanishes when neither the store nor one of its tracks is used any more.
        """
        self._folder = folder
        self._file: FileIO | io.BytesIO | None = None if folder else io.BytesIO()
        self._size = 0
        self._growing: dict[type[Track], list[_Growing]] = {}

    def append(self, kind: type[Track], tracks: Sequence[Mapping[str, Any]]) -> None:
        """Append rows to all tracks of a kind.

        Args:
            kind: of the tracks.
            tracks: fields of each track, with its new rows; always the same tracks in one order.

        Raises:
            OutputError: the rows cannot be written (disk full).
        """
        if kind not in self._growing:
            self._growing[kind] = [_Growing(self, kind, new) for new in tracks]
        for track, new in zip(self._growing[kind], tracks, strict=True):
            track.append(new)

    def tracks(self, kind: type[Kind]) -> tuple[Kind, ...]:
        """All tracks of a kind as they are now."""
        tracks = (_STORED[kind](growing) for growing in self._growing.get(kind, []))
        return tuple(t if self._folder else t.in_memory() for t in tracks)

    def between(self, kind: type[Kind], start_s: float, stop_s: float) -> tuple[Kind, ...]:
        """The rows of all tracks of a kind whose time lies in [start_s, stop_s], in memory."""
        tracks = (_STORED[kind](growing) for growing in self._growing.get(kind, []))
        return tuple(t.between(start_s, stop_s) for t in tracks)

    def write(self, block: bytes) -> int:
        """Append a block to the file; returns its place."""
        try:
            if self._file is None:  # short recordings never need it
                self._file = tempfile.TemporaryFile(dir=self._folder, buffering=0)  # noqa: SIM115
                weakref.finalize(self, self._file.close)
            self._file.seek(self._size)
            write_all(self._file, block)
        except OSError as error:
            raise OutputError(f"{self._folder}: cannot be written: {reason(error)}") from error
        self._size += len(block)
        return self._size - len(block)

    def read(self, place: int, out: NDArray[Any]) -> None:
        """Fill an array with what was written from a place on."""
        assert self._file is not None
        self._file.seek(place)
        read_all(self._file, out.data.cast("B"))


class _Growing:
    """One track: full blocks in the store's file, the last one here."""

    def __init__(self, store: RowStore, kind: type[Track], like: Mapping[str, Any]) -> None:
        self.constants = {name: like[name] for name in kind.NOT_COLUMNS}
        self.epochs = 0
        self._store = store
        self._places = array("q")
        self._last: dict[str, NDArray[Any]] = {}
        self._offsets: dict[str, int] = {}
        size = 0
        for name in kind.columns():
            column: NDArray[Any] = like[name]
            self._last[name] = np.empty((BLOCK_EPOCHS, *column.shape[1:]), column.dtype)
            self._offsets[name] = size
            size += self._last[name].nbytes

    def append(self, new: Mapping[str, Any]) -> None:
        done, count = 0, len(new[next(iter(self._last))])
        while done < count:
            fill = self.epochs % BLOCK_EPOCHS
            more = min(count - done, BLOCK_EPOCHS - fill)
            for name, block in self._last.items():
                block[fill : fill + more] = new[name][done : done + more]
            done += more
            if fill + more == BLOCK_EPOCHS:
                block_bytes = b"".join(block.data for block in self._last.values())
                self._places.append(self._store.write(block_bytes))
            self.epochs += more

    def column(self, name: str, start: int, stop: int) -> NDArray[Any]:
        start, stop, _ = slice(start, stop).indices(self.epochs)
        last, offset = self._last[name], self._offsets[name]
        out = np.empty((max(stop - start, 0), *last.shape[1:]), last.dtype)
        row_bytes = last[0].nbytes
        at = start
        while at < stop:
            number, row = divmod(at, BLOCK_EPOCHS)
            end = min(stop, at - row + BLOCK_EPOCHS)
            here = out[at - start : end - start]
            if number < len(self._places):
                self._store.read(self._places[number] + offset + row * row_bytes, here)
            else:
                here[:] = last[row : row + end - at]
            at = end
        return out


class _Stored(Track):
    """A track whose columns are read when they are asked for."""

    _kind: ClassVar[Any]
    _rows: _Growing

    def __init__(self, rows: _Growing) -> None:
        vars(self).update(rows.constants, _rows=rows)

    def __getattr__(self, name: str) -> Any:
        if name in self.columns():
            return self._rows.column(name, 0, self.epochs)
        raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'")

    @property
    def epochs(self) -> int:
        return self._rows.epochs

    def part(self, start: int, stop: int) -> Self:
        columns = {name: self._rows.column(name, start, stop) for name in self.columns()}
        track: Self = self._kind(**self._rows.constants, **columns)
        return track

    def time_at(self, row: int) -> float:
        return float(self._rows.column("time_s", row, row + 1)[0])

    def in_memory(self) -> Self:
        return self.part(0, self.epochs)


class _StoredSignalTrack(_Stored, SignalTrack):
    _kind = SignalTrack


class _StoredComboTrack(_Stored, ComboTrack):
    _kind = ComboTrack


_STORED: dict[type[Track], Any] = {SignalTrack: _StoredSignalTrack, ComboTrack: _StoredComboTrack}
