"""Dataclasses to HDF5 groups and back: one dataset per field, units from the field's name."""

from __future__ import annotations

import dataclasses
import math
import types
import typing
from typing import TYPE_CHECKING, Any, TypeVar

import h5py
import numpy as np

from sdr_spoof.records import Alarm, SatelliteVerdict, Track, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

Record = TypeVar("Record")
AnyTrack = TypeVar("AnyTrack", bound=Track)

UNITS = {
    "_m_s": "m/s",
    "_hz_s": "Hz/s",
    "_deg": "deg",
    "_rad": "rad",
    "_dbhz": "dB-Hz",
    "_hz": "Hz",
    "_s": "s",
    "_cycles": "cycle",
    "_chips": "chip",
    "_m": "m",
    "sample_index": "sample",
}
"""Units by the ending of a field's name; "1" for all others."""


def unit_of(name: str) -> str:
    """Unit of a field."""
    return next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "1")


def write_array(group: h5py.Group, name: str, value: Any) -> None:
    """Write numbers with their unit."""
    _create(group, name, data=value)


def _create(group: h5py.Group, name: str, **content: Any) -> h5py.Dataset:
    dataset = group.create_dataset(name, **content, track_times=False)
    dataset.attrs["units"] = unit_of(name)
    return dataset


def write_text(group: h5py.Group, name: str, text: str | Sequence[str]) -> None:
    """Write text of fixed length (variable length would leave stale bytes in the file)."""
    encoded = np.char.encode(np.asarray(text, dtype=np.str_), "utf-8")
    kind = h5py.string_dtype("utf-8", max(encoded.dtype.itemsize, 1))
    dataset = group.create_dataset(name, data=encoded.astype(kind), dtype=kind, track_times=False)
    dataset.attrs["units"] = "1"


def read_text(dataset: h5py.Dataset) -> str:
    """Read one text."""
    return bytes(dataset[()]).decode("utf-8")


def write_track(group: h5py.Group, track: Track) -> None:
    """Write a track part by part, so that it need not be in memory."""
    like = track.part(0, 0)
    columns = {}
    for field in dataclasses.fields(track):
        value = getattr(like, field.name)
        if isinstance(value, str):
            write_text(group, field.name, value)
        elif field.name in track.columns():
            shape = (track.epochs, *value.shape[1:])
            columns[field.name] = _create(group, field.name, shape=shape, dtype=value.dtype)
        else:
            write_array(group, field.name, value)
    at = 0
    for part in track.parts():
        for name, dataset in columns.items():
            dataset[at : at + part.epochs] = getattr(part, name)
        at += part.epochs


def read_track(group: h5py.Group, kind: type[AnyTrack]) -> AnyTrack:
    """Read what :func:`write_track` wrote."""
    return kind(**{f.name: _scalar_or_array(group[f.name]) for f in dataclasses.fields(kind)})


def write_rows(group: h5py.Group, kind: type, rows: Sequence[Any]) -> None:
    """Write records of numbers and texts, one dataset per field, one element per record.

    None becomes NaN or the empty text.
    """
    group.attrs["rows"] = len(rows)
    for name, type_ in _scalar_types(kind).items():
        column = [getattr(row, name) for row in rows]
        if type_ is str:
            write_text(group, name, ["" if v is None else v for v in column])
        else:
            write_array(group, name, np.array(column, dtype=_DTYPES[type_]))


def read_rows(group: h5py.Group, kind: type[Record], **more: Any) -> list[Record]:
    """Read what :func:`write_rows` wrote; ``more`` gives the fields that were not written."""
    optional = {n for n, t in typing.get_type_hints(kind).items() if _none(t)}
    columns = {
        name: _column(group[name], type_, name in optional)
        for name, type_ in _scalar_types(kind).items()
    }
    count = int(group.attrs["rows"])
    return [kind(**{n: c[i] for n, c in columns.items()}, **more) for i in range(count)]


def write_verdict(group: h5py.Group, verdict: Verdict) -> None:
    """Write a verdict: flat tables of satellites and of alarms (joined by system and PRN)."""
    group.attrs["spoofed"] = verdict.spoofed
    write_text(group, "limits", verdict.limits)
    write_rows(group.create_group("satellites"), SatelliteVerdict, verdict.satellites)
    alarms = [alarm for satellite in verdict.satellites for alarm in satellite.alarms]
    write_rows(group.create_group("alarms"), Alarm, alarms)


def read_verdict(group: h5py.Group) -> Verdict:
    """Read what :func:`write_verdict` wrote."""
    alarms = read_rows(group["alarms"], Alarm)
    satellites = (
        dataclasses.replace(
            s, alarms=tuple(a for a in alarms if (a.system, a.prn) == (s.system, s.prn))
        )
        for s in read_rows(group["satellites"], SatelliteVerdict, alarms=())
    )
    limits = read_text(group["limits"])
    return Verdict(bool(group.attrs["spoofed"]), tuple(satellites), limits)


_DTYPES: dict[type, Any] = {bool: np.bool_, int: np.int64, float: np.float64}


def _none(annotation: Any) -> bool:
    return type(None) in typing.get_args(annotation)


def _scalar_types(kind: type) -> dict[str, type]:
    """Fields that are a number or a text (or None), with that type."""
    hints = typing.get_type_hints(kind)
    scalars: dict[str, type] = {}
    for name, annotation in hints.items():
        options = [annotation]
        if isinstance(annotation, types.UnionType):
            options = [a for a in typing.get_args(annotation) if a is not type(None)]
        if options[0] in (str, *_DTYPES):
            scalars[name] = options[0]
    return scalars


def _column(dataset: h5py.Dataset, type_: type, optional: bool) -> list[Any]:
    if type_ is str:
        texts = [bytes(v).decode("utf-8") for v in dataset[()]]
        return [t or None for t in texts] if optional else list(texts)
    values = dataset[()].tolist()
    return [None if optional and math.isnan(v) else v for v in values]


def _scalar_or_array(dataset: h5py.Dataset) -> Any:
    if h5py.check_string_dtype(dataset.dtype) is not None:
        return read_text(dataset)
    value = dataset[()]
    return value if dataset.shape else value.item()
