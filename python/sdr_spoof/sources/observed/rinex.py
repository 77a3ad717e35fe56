"""RINEX 3 and 4 observation files, plain or compressed with gzip.

Source: RINEX 3.05 (IGS/RTCM-SC104, 2020), section 6 and table A3. Signals that the registry does
not know are left out, and a note says so. A damaged line is an error that names it: what comes
after it could be anything. Values of 0 are missing ones.
"""

from __future__ import annotations

import gzip
import math
import zlib
from collections import Counter
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import ObservationError
from sdr_spoof.nav.time import GnssTime, leap_seconds
from sdr_spoof.observations import Observations, ObservedSignal
from sdr_spoof.signals import signal_ids, signal_spec

from .model import Observed, ObservedReader
from .rinex_header import KINDS, Header, finite, read_header, wrong

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

LOST, HALF = 1, 2
"""Bits of the loss-of-lock indicator."""
POWER_FAILURE, CYCLE_SLIPS = 1, 6
"""Epoch flags; those from 2 to 5 are events with lines of the header."""
CELL = 16
"""Characters of a value with its indicators."""
ASSUMED_DBHZ = 42.0
"""C/N0 of signals whose strength the file does not tell."""
_GZIP = b"\x1f\x8b"


@dataclass
class _Column:
    """What was read of one signal, by number of the epoch."""

    epochs: list[int] = field(default_factory=list)
    values: list[tuple[float, float, float, float]] = field(default_factory=list)
    flags: list[int] = field(default_factory=list)


@dataclass
class _Read:
    """What was read so far."""

    times: list[GnssTime] = field(default_factory=list)
    columns: dict[ObservedSignal, _Column] = field(default_factory=dict)
    restarts: list[int] = field(default_factory=list)
    """Epochs before which the power failed."""
    unknown: Counter[str] = field(default_factory=Counter)


def read(path: Path) -> Observed:
    """Read a file.

    Raises:
        ObservationError: as :func:`parse`, or it cannot be read.
    """
    try:
        data = path.read_bytes()
        data = gzip.decompress(data) if data.startswith(_GZIP) else data
    except (OSError, EOFError, zlib.error) as error:
        raise ObservationError(f"{path}: cannot be read: {error}; fetch it again") from error
    return parse(data.decode("latin-1"), str(path))


def parse(text: str, name: str = "observation file") -> Observed:
    """Read the text of a file.

    Raises:
        ObservationError: it is no such file, or a line is damaged; the message names the line.
    """
    lines = text.replace("\r", "").split("\n")
    while lines and not lines[-1].strip():
        lines.pop()
    header, first = read_header(lines, name)
    found = _Read()
    rows = _Rows(lines, first, name)
    while rows.more:
        _epoch(rows, header, found)
    if not found.times:
        raise wrong(name, len(lines), "the file has no epoch; give one with observations")
    notes = [
        f"{name}: {count} observations of {what} are not used: the registry has no such signal"
        for what, count in sorted(found.unknown.items())
    ]
    if not header.decibels:
        notes.append(f"{name}: strengths are not in dB-Hz; {ASSUMED_DBHZ:g} dB-Hz are assumed")
    return Observed(_observations(found, header), None, None, header.position_m, tuple(notes))


class _Rows:
    """Lines, and where we are."""

    def __init__(self, lines: list[str], at: int, name: str) -> None:
        self._lines, self.at, self.name = lines, at, name

    @property
    def more(self) -> bool:
        return self.at < len(self._lines)

    def next(self, within: str) -> str:
        if not self.more:
            raise wrong(
                self.name,
                len(self._lines),
                f"the file ends within {within}; it is cut off: fetch it again, or delete the "
                "lines of that epoch",
            )
        self.at += 1
        return self._lines[self.at - 1]

    def wrong(self, what: str) -> ObservationError:
        return wrong(self.name, self.at, what)


def _epoch(rows: _Rows, header: Header, found: _Read) -> None:
    """One epoch with its satellites, or an event."""
    line = rows.next("an epoch")
    if not line.startswith(">"):
        raise rows.wrong(f"'{line[:20].strip()}' stands where an epoch ('>') must begin")
    try:
        flag, count = int(line[31:32].strip() or 0), int(line[32:35])
    except ValueError as error:
        raise rows.wrong("flag and number of satellites of the epoch cannot be read") from error
    if 2 <= flag <= 5:
        for _ in range(count):
            header.take(rows.next("an event"), rows.at)
        return
    time = _time(line, header, rows)
    if flag == CYCLE_SLIPS:
        for _ in range(count):
            rows.next("a list of cycle slips")
        return
    if flag > CYCLE_SLIPS or count < 0:
        raise rows.wrong(f"epoch flag {flag} with {count} satellites is not defined")
    if found.times and time - found.times[-1] <= 0:
        raise rows.wrong("the epoch is not later than the one before; sort the file")
    if flag == POWER_FAILURE:
        found.restarts.append(len(found.times))
    seen: set[str] = set()
    for _ in range(count):
        satellite = rows.next("an epoch")
        name = satellite[:3].replace(" ", "0")
        if name in seen:
            raise rows.wrong(f"satellite {name} comes twice in one epoch")
        seen.add(name)
        for signal, values, flags in _cells(satellite, name, header, rows, found):
            column = found.columns.setdefault(signal, _Column())
            column.epochs.append(len(found.times))
            column.values.append(values)
            column.flags.append(flags)
    found.times.append(time)


def _time(line: str, header: Header, rows: _Rows) -> GnssTime:
    """Epoch as GPST."""
    try:
        parts = line[2:18].split()
        year, month, day, hour, minute = (int(p) for p in parts)
        second = finite(line[18:29])
        if not 0 <= second < 61 or not 1980 <= year <= 2200:
            raise ValueError(line)
        date = datetime(year, month, day, hour, minute, tzinfo=UTC)
    except ValueError as error:
        raise rows.wrong(f"'{line[2:29].strip()}' is not a date") from error
    whole = GnssTime.of_calendar(date, "C" if header.time_system == "BDT" else "G")
    if header.time_system == "GLO":
        whole = whole + float(leap_seconds(date))
    # Seconds have seven decimals.
    ticks = round(second * 1e7)
    return GnssTime(whole.seconds + ticks // 10**7, (ticks % 10**7) * 1e-7)


def _cells(
    line: str, name: str, header: Header, rows: _Rows, found: _Read
) -> Iterator[tuple[ObservedSignal, tuple[float, float, float, float], int]]:
    """Signals of a satellite with their four values and the flags of their phase."""
    system = name[:1]
    if not name[1:].isdecimal() or system not in header.types:
        raise rows.wrong(f"'{line[:3]}' is not a satellite of the header's systems")
    if len(line) > 3 + CELL * len(header.types[system]):
        raise rows.wrong(f"{name} has more values than the header has types for system {system}")
    known = header.columns(system)
    if not known:
        found.unknown[f"system {system}"] += 1
    for signal, columns in known.items():
        values, flags = _values(line, columns, header, rows)
        if math.isfinite(values[0]) or math.isfinite(values[1]):
            if int(name[1:]) not in _prns(signal):
                raise rows.wrong(f"there is no satellite {name} that sends {signal}")
            yield ObservedSignal(system, int(name[1:]), signal), values, flags


def _values(
    line: str, columns: dict[str, int], header: Header, rows: _Rows
) -> tuple[tuple[float, float, float, float], int]:
    """Pseudorange, phase, Doppler and C/N0; and bits of the loss-of-lock indicator."""
    found, flags, digit = dict.fromkeys(KINDS, math.nan), 0, 0
    for kind, column in columns.items():
        at = 3 + CELL * column
        found[kind] = _value(line[at : at + 14].strip(), at, rows)
        found[kind] /= header.scale.get((line[0], header.types[line[0]][column]), 1.0)
        digit = _digit(line[at + 15 : at + 16], rows) if kind in "CL" else digit
        flags = _digit(line[at + 14 : at + 15], rows) if kind == "L" else flags
    cn0 = found["S"] if header.decibels else math.nan
    if math.isnan(cn0):
        cn0 = 6.0 * digit + 3.0 if digit else ASSUMED_DBHZ
    return (found["C"], found["L"], found["D"], cn0), flags


def _value(text: str, at: int, rows: _Rows) -> float:
    """A number; NaN where there is none."""
    if not text:
        return math.nan
    try:
        return finite(text) or math.nan
    except ValueError:
        raise rows.wrong(f"'{text}' in column {at + 1} is not a number") from None


def _digit(text: str, rows: _Rows) -> int:
    """An indicator; blank is 0."""
    if text in ("", " "):
        return 0
    if text not in "0123456789":
        raise rows.wrong(f"indicator '{text}' is not a digit")
    return int(text)


@cache
def _prns(signal: str) -> frozenset[int]:
    return frozenset(signal_spec(signal).prns)


def _observations(found: _Read, header: Header) -> Observations:
    """Columns in order of system, PRN and signal."""
    signals = sorted(found.columns)
    if not signals:
        raise ObservationError(
            f"{header.name}: has no signal that the registry knows "
            f"({', '.join(s for s in signal_ids())}); give a file with one of them"
        )
    shape = (len(found.times), len(signals))
    values, flags = np.full((*shape, len(KINDS)), np.nan), np.zeros(shape, np.int64)
    for column, signal in enumerate(signals):
        own = found.columns[signal]
        values[own.epochs, column] = own.values
        flags[own.epochs, column] = own.flags
    reference = GnssTime(found.times[0].seconds)
    time_s = np.array([t - reference for t in found.times])
    pseudorange, phase, doppler, cn0 = np.moveaxis(values, -1, 0)
    return Observations(
        reference=reference,
        time_s=time_s,
        sample_time_s=time_s - time_s[0],
        interval_s=float(np.median(np.diff(time_s))) if len(time_s) > 1 else 1.0,
        signals=tuple(signals),
        pseudorange_m=pseudorange.copy(),
        carrier_phase_cycles=phase.copy(),
        doppler_hz=doppler.copy(),
        cn0_dbhz=cn0.copy(),
        lock_lost=_lost(phase, (flags & LOST) > 0, found.restarts),
        half_cycle=(flags & HALF) > 0,
        spoofed=np.zeros(shape, np.bool_),
    )


def _lost(
    phase: NDArray[np.float64], told: NDArray[np.bool_], restarts: list[int]
) -> NDArray[np.bool_]:
    """Where the phase may have begun anew, (E, S): as told, and after any epoch without it."""
    there = np.isfinite(phase)
    before = np.vstack([np.zeros_like(there[:1]), there[:-1]])
    lost = told | (there & ~before)
    lost[restarts] = True
    return np.asarray(lost)


READER = ObservedReader("RINEX", lambda path: True, read)
