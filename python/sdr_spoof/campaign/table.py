"""The table of a campaign: one row per run, sorted by point and run, in an HDF5 file.

The same campaign gives the same bytes, on any executor and after any number of interruptions.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from sdr_spoof.errors import RecordingError
from sdr_spoof.sinks.atomic import replacing
from sdr_spoof.sinks.hdf5_file import new_file
from sdr_spoof.sinks.hdf5_records import write_array, write_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from .columns import Column, Kind
    from .journal import Record

FORMAT_VERSION = 1
FIXED: dict[str, Kind] = {"point": "number", "run": "number", "seed": "number", "error": "text"}
"""Columns that every table begins with; the first three are whole numbers."""


@dataclass(frozen=True)
class Table:
    """Columns of equal length; rows sorted by point and run.

    Numbers are float64 with NaN for none, flags int8 with -1 for none, texts ``str`` with the
    empty text for none.
    """

    axes: tuple[str, ...]
    """Columns of what was varied."""
    columns: dict[str, NDArray[Any]]
    partial: bool
    """True while runs are missing."""
    spec: dict[str, Any]
    """What was run, see :class:`~sdr_spoof.campaign.spec.CampaignSpec`."""

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.columns["point"])

    def __getitem__(self, name: str) -> NDArray[Any]:
        """One column."""
        return self.columns[name]

    def where(self, rows: NDArray[np.bool_]) -> Table:
        """Some of its rows."""
        kept = {name: column[rows] for name, column in self.columns.items()}
        return Table(self.axes, kept, self.partial, self.spec)


def table_of(
    records: Iterable[Record],
    columns: Sequence[Column],
    values_of: Sequence[Sequence[tuple[str, float | str]]],
    spec: dict[str, Any],
    total: int,
) -> Table:
    """Sort the runs and set their columns up.

    Args:
        records: runs in any order; of a repeated one the last counts.
        columns: what the records' values are.
        values_of: column and value of each axis, for each point.
        spec: what was run.
        total: runs of the whole campaign.
    """
    latest = {(r.point, r.run): r for r in records}
    rows = [latest[key] for key in sorted(latest)]
    made: dict[str, NDArray[Any]] = {
        name: np.array([getattr(r, name) for r in rows], dtype=np.int64)
        for name in ("point", "run", "seed")
    }
    made["error"] = np.array([r.error for r in rows], dtype=np.str_)
    axes = tuple(name for name, _ in values_of[0])
    for number, name in enumerate(axes):
        made[name] = _axis([values_of[r.point][number][1] for r in rows])
    for number, column in enumerate(columns):
        made[column.name] = _array(column, [None if r.error else r.values[number] for r in rows])
    return Table(axes, made, len(rows) < total, spec)


def write_table(path: Path, table: Table) -> None:
    """Write the table, in place of an earlier one.

    Raises:
        OutputError: it cannot be written.
    """
    with replacing(path, force=True) as temporary, new_file(temporary) as file:
        file.attrs["partial"] = table.partial
        file.attrs["format_version"] = FORMAT_VERSION
        write_text(file, "spec", json.dumps(table.spec))
        write_text(file, "axes", json.dumps(table.axes))
        group = file.create_group("runs", track_order=True)
        for name, column in table.columns.items():
            if column.dtype.kind == "U":
                write_text(group, name, column.tolist())
            else:
                write_array(group, name, column)


def read_table(path: Path) -> Table:
    """Read what :func:`write_table` wrote.

    Raises:
        RecordingError: it is missing or no such file.
    """
    try:
        with h5py.File(path) as file:
            group = file["runs"]
            return Table(
                axes=tuple(json.loads(_text(file["axes"]))),
                columns={name: _column(group[name]) for name in group},
                partial=bool(file.attrs["partial"]),
                spec=json.loads(_text(file["spec"])),
            )
    except (OSError, KeyError, ValueError) as error:
        raise RecordingError(f"{path}: is no table of a campaign: {error}") from error


def _axis(values: list[float | str]) -> NDArray[Any]:
    numbers = all(isinstance(v, float) for v in values)
    return np.array(values, dtype=np.float64 if numbers else np.str_)


def _array(column: Column, values: list[Any]) -> NDArray[Any]:
    if column.kind == "text":
        return np.array(["" if v is None else v for v in values], dtype=np.str_)
    if column.kind == "flag":
        return np.array([-1 if v is None else v for v in values], dtype=np.int8)
    return np.array([np.nan if v is None else v for v in values], dtype=np.float64)


def _text(dataset: h5py.Dataset) -> str:
    return bytes(dataset[()]).decode("utf-8")


def _column(dataset: h5py.Dataset) -> NDArray[Any]:
    if dataset.dtype.kind == "S":
        return np.asarray(np.char.decode(dataset[()], "utf-8"))
    return np.asarray(dataset[()])
