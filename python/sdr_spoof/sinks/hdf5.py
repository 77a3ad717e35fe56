"""Result files: HDF5 with units as attributes, the same bytes for the same result.

Layout: ``/`` holds ``partial`` and ``format_version``; ``/recording`` the format of the samples;
``/config`` the effective configuration (JSON); ``/acquisitions`` one column per field;
``/tracks/<signal>_<prn>`` and ``/combos/<lower>_<upper>_<prn>`` one column per field, one row per
epoch;
``/second_peaks`` one column per field, one row per search; ``/breaks``, where there are any, one
row per :class:`CountBreak`; ``/gain``, where that of the recorder was logged; ``/verdict`` with
tables of satellites and alarms; ``/navigation``, ``/observations`` and ``/fixes`` as
:mod:`.hdf5_nested` has it. Every dataset has the attribute
``units`` ("1" where it has none). No dates are stored.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import h5py

from sdr_spoof.errors import RecordingError
from sdr_spoof.gain import COLUMNS as GAIN
from sdr_spoof.gain import GainLog
from sdr_spoof.gaps import CountBreak
from sdr_spoof.records import (
    Acquisition,
    ComboTrack,
    SecondPeak,
    SignalTrack,
    TrackLog,
    Verdict,
)
from sdr_spoof.sources import RecordingFormat

from . import hdf5_records as records
from .atomic import replacing
from .hdf5_classes import CLASSES
from .hdf5_file import new_file
from .hdf5_nested import read_nested, write_nested

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic import BaseModel

    from sdr_spoof.fixes import Fixes
    from sdr_spoof.nav.records import Navigation
    from sdr_spoof.observations import Observations
    from sdr_spoof.sources import Recording

Record = TypeVar("Record")

_VERSION = 1
NESTED = ("navigation", "observations", "fixes")
"""Results of positioning: groups of nested records."""


@dataclass(frozen=True)
class Result:
    """What a result file holds."""

    recording: str
    """Name of the data file."""
    format: RecordingFormat
    config: dict[str, Any]
    """Effective configuration, group by group."""
    acquisitions: tuple[Acquisition, ...] = ()
    log: TrackLog | None = None
    verdict: Verdict | None = None
    navigation: Navigation | None = None
    observations: Observations | None = None
    fixes: Fixes | None = None
    start: datetime | None = None
    """UTC of the first sample, where it is known."""

    @classmethod
    def of(
        cls,
        recording: Recording,
        config: BaseModel,
        *,
        acquisitions: Sequence[Acquisition] = (),
        log: TrackLog | None = None,
        verdict: Verdict | None = None,
        **located: Any,
    ) -> Result:
        """Gather the result of processing a recording; ``located`` as the fields below."""
        plain = config.model_dump(mode="json")
        found = {"acquisitions": tuple(acquisitions), "log": log, "verdict": verdict, **located}
        name, form = recording.path.name, recording.format
        return cls(name, form, plain, start=recording.start, **found)

    @property
    def partial(self) -> bool:
        """Whether processing was interrupted."""
        return self.log is not None and self.log.partial


def write_result(path: Path | str, result: Result, *, force: bool = False) -> None:
    """Write a result file; it appears whole or not at all.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written (disk full).
    """
    with replacing(Path(path), force=force) as temporary, new_file(temporary) as file:
        _write(file, result)


def read_result(path: Path | str) -> Result:
    """Read a result file.

    Raises:
        RecordingError: missing, or not a result file of this version.
    """
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format_version") != _VERSION:
                raise RecordingError(f"{path}: not a result file of this version of sdr-spoof")
            return _read(file)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read as a result file: {error}") from error
    except KeyError as error:
        raise RecordingError(f"{path}: not a complete result file: {error}") from error


def _write(file: h5py.File, result: Result) -> None:
    file.attrs["format_version"] = _VERSION
    file.attrs["partial"] = result.partial
    recording = file.create_group("recording")
    records.write_text(recording, "name", result.recording)
    records.write_text(recording, "format", json.dumps(result.format.model_dump()))
    if result.start is not None:
        records.write_text(recording, "start", result.start.isoformat())
    records.write_text(file, "config", json.dumps(result.config, sort_keys=True))
    records.write_rows(file.create_group("acquisitions"), Acquisition, result.acquisitions)
    if result.log is not None:
        _write_log(file, result.log)
    if result.verdict is not None:
        records.write_verdict(file.create_group("verdict"), result.verdict)
    for name in NESTED:
        if getattr(result, name) is not None:
            write_nested(file.create_group(name, track_order=True), getattr(result, name))


def _write_log(file: h5py.File, log: TrackLog) -> None:
    group = file.create_group("log")
    records.write_text(group, "recording", log.recording)
    for name in ("sample_rate_hz", "duration_s"):
        records.write_array(group, name, getattr(log, name))
    records.write_rows(file.create_group("second_peaks"), SecondPeak, log.second_peaks)
    if log.breaks:
        records.write_rows(file.create_group("breaks"), CountBreak, log.breaks)
    if log.gain is not None:
        for name in GAIN:
            records.write_array(file.require_group("gain"), name, getattr(log.gain, name))
    # In the order of the log, not of the names.
    tracks = file.create_group("tracks", track_order=True)
    for track in log.signals:
        records.write_track(tracks.create_group(f"{track.signal}_{track.prn:03d}"), track)
    combos = file.create_group("combos", track_order=True)
    for combo in log.combos:
        records.write_track(
            combos.create_group(f"{combo.lower}_{combo.upper}_{combo.prn:03d}"), combo
        )


def _read(file: h5py.File) -> Result:
    format = RecordingFormat(**json.loads(records.read_text(file["recording/format"])))
    return Result(
        recording=records.read_text(file["recording/name"]),
        format=format,
        config=json.loads(records.read_text(file["config"])),
        start=datetime.fromisoformat(records.read_text(file["recording/start"]))
        if "start" in file["recording"]
        else None,
        acquisitions=tuple(records.read_rows(file["acquisitions"], Acquisition)),
        log=_read_log(file) if "log" in file else None,
        verdict=records.read_verdict(file["verdict"]) if "verdict" in file else None,
        **{name: read_nested(file[name], CLASSES) for name in NESTED if name in file},
    )


def _read_rows(file: h5py.File, name: str, kind: type[Record]) -> tuple[Record, ...]:
    """Rows that a file need not have."""
    return tuple(records.read_rows(file[name], kind)) if name in file else ()


def _read_log(file: h5py.File) -> TrackLog:
    group = file["log"]
    return TrackLog(
        recording=records.read_text(group["recording"]),
        sample_rate_hz=float(group["sample_rate_hz"][()]),
        duration_s=float(group["duration_s"][()]),
        partial=bool(file.attrs["partial"]),
        signals=tuple(records.read_track(g, SignalTrack) for g in file["tracks"].values()),
        combos=tuple(records.read_track(g, ComboTrack) for g in file["combos"].values()),
        second_peaks=_read_rows(file, "second_peaks", SecondPeak),
        breaks=_read_rows(file, "breaks", CountBreak),
        gain=GainLog(*(file["gain"][name][()] for name in GAIN)) if "gain" in file else None,
    )
