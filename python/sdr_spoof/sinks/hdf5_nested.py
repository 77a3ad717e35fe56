"""Frozen records that hold times, arrays and tables of other records, to HDF5 groups and back.

Every value says by its attribute ``kind`` how it is stored, so that reading needs no type hints:

- ``array``: as it is; ``number``, ``text``: one value;
- ``time``: whole seconds and fraction of GPST since 1980-01-06 in the last axis, NaN for none;
- ``json``: what has no better form, tuples as lists;
- a group of kind ``table`` holds one column for each field of a row, all of the same class;
- a group of kind ``record`` holds one record.
"""

from __future__ import annotations

import dataclasses
import json
from itertools import groupby
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from sdr_spoof.nav.time import GnssTime

from .hdf5_records import read_text, unit_of, write_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    Classes = Mapping[str, type]


def write_nested(group: h5py.Group, record: Any) -> None:
    """Write a record into a group of its own; fields that are None are left out."""
    group.attrs["kind"] = "record"
    group.attrs["class"] = type(record).__name__
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        if value is not None:
            _write_value(group, field.name, value)


def read_nested(group: h5py.Group, classes: Classes) -> Any:
    """Read what :func:`write_nested` wrote; ``classes`` by their names.

    Raises:
        KeyError: a class is not among them.
    """
    values = {name: _read_value(item, classes) for name, item in group.items()}
    made = classes[group.attrs["class"]]
    missing = {f.name: None for f in dataclasses.fields(made) if f.name not in values}
    return made(**values, **missing)


def _write_value(group: h5py.Group, name: str, value: Any) -> None:
    if _is_record(value) and not isinstance(value, GnssTime):
        write_nested(group.create_group(name, track_order=True), value)
    elif isinstance(value, tuple) and value and all(_is_record(v) for v in value):
        _write_tables(group.create_group(name, track_order=True), value)
    else:
        _write_leaf(group, name, value)


def _is_record(value: Any) -> bool:
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def _write_leaf(group: h5py.Group, name: str, value: Any) -> None:
    if isinstance(value, GnssTime):
        _dataset(group, name, "time", [value.seconds, value.fraction])
    elif isinstance(value, np.ndarray):
        _dataset(group, name, "array", value)
    elif isinstance(value, str):
        _text(group, name, "text", value)
    elif isinstance(value, bool | int | float | np.generic):
        _dataset(group, name, "number", value)
    else:
        _text(group, name, "json", json.dumps(value))


def _dataset(group: h5py.Group, name: str, kind: str, value: Any) -> None:
    made = group.create_dataset(name, data=value, track_times=False)
    made.attrs["units"] = "s" if kind == "time" else unit_of(name)
    made.attrs["kind"] = kind


def _text(group: h5py.Group, name: str, kind: str, value: str | Sequence[str]) -> None:
    write_text(group, name, value)
    group[name].attrs["kind"] = kind


def _write_tables(group: h5py.Group, rows: Sequence[Any]) -> None:
    """Write one table for each stretch of rows of one class."""
    group.attrs["kind"] = "tables"
    for number, (kind, part) in enumerate(groupby(rows, type)):
        table = group.create_group(f"{number:02d}_{kind.__name__}", track_order=True)
        table.attrs["kind"] = "table"
        table.attrs["class"] = kind.__name__
        members = list(part)
        table.attrs["rows"] = len(members)
        for field in dataclasses.fields(kind):
            _write_column(table, field.name, [getattr(m, field.name) for m in members])


def _write_column(table: h5py.Group, name: str, column: list[Any]) -> None:
    kinds = {type(v) for v in column}
    if kinds <= {GnssTime, type(None)} and GnssTime in kinds:
        nothing = (np.nan, np.nan)
        rows = [nothing if t is None else (t.seconds, t.fraction) for t in column]
        _dataset(table, name, "time", np.array(rows, np.float64))
    elif kinds == {str}:
        _text(table, name, "text", column)
    elif kinds in ({bool}, {int}) or (kinds and kinds <= {float, int, np.float64}):
        _dataset(table, name, "number", np.array(column))
    elif kinds == {np.ndarray} and all(
        v.dtype == np.uint8 and v.max(initial=0) < 2 for v in column
    ):
        _text(table, name, "bits", ["".join(map(str, v.tolist())) for v in column])
    else:
        _text(table, name, "json", [json.dumps(_plain(v)) for v in column])


def _are_bits(values: np.ndarray) -> bool:
    return values.dtype == np.uint8 and bool(values.max(initial=0) <= 1)


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


def _read_value(item: h5py.Group | h5py.Dataset, classes: Classes) -> Any:
    kind = item.attrs["kind"]
    if kind == "record":
        return read_nested(item, classes)
    if kind == "tables":
        return tuple(row for table in item.values() for row in _read_table(table, classes))
    if kind == "array":
        return item[()]
    if kind == "time":
        return _time(item[()])
    if kind == "number":
        return item[()].item()
    text = read_text(item)
    return _tuples(json.loads(text)) if kind == "json" else text


def _read_table(table: h5py.Group, classes: Classes) -> list[Any]:
    made = classes[table.attrs["class"]]
    columns = {name: _read_column(item) for name, item in table.items()}
    rows = range(int(table.attrs["rows"]))
    return [made(**{name: column[i] for name, column in columns.items()}) for i in rows]


def _read_column(item: h5py.Dataset) -> list[Any]:
    kind = item.attrs["kind"]
    if kind == "time":
        return [_time(row) for row in item[()]]
    if kind == "number":
        return list(item[()].tolist())
    texts = [bytes(v).decode("utf-8") for v in item[()]]
    if kind == "bits":
        return [np.frombuffer(t.encode(), np.uint8) - ord("0") for t in texts]
    return [_tuples(json.loads(t)) for t in texts] if kind == "json" else texts


def _time(row: Any) -> GnssTime | None:
    return None if np.isnan(row[0]) else GnssTime(int(row[0]), float(row[1]))


def _tuples(value: Any) -> Any:
    return tuple(_tuples(v) for v in value) if isinstance(value, list) else value
