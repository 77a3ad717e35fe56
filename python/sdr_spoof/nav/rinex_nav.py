"""RINEX navigation files, versions 3 and 4: GPS and BDS.

Sources: RINEX 3.05 and 4.00 (IGS/RTCM). A record that cannot be read is left out and told in the
notes, with its line; only a file that is no such file at all is an error.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from ..errors import NavigationError
from . import rinex_orbits
from .beidou_satellites import GEO
from .broadcast import Bdgim, Contents, Klobuchar
from .ephemeris import D1, D2, LNAV
from .records import Navigation
from .rinex_header import Header, read_header
from .rinex_lines import MalformedError, epoch, numbers, whole
from .rinex_offsets import offset_contents

SYSTEMS = "GC"
MOST_NOTES = 50
"""Further ones are counted only."""


def read_navigation(path: Path | str) -> Navigation:
    """Read a file.

    Raises:
        NavigationError: if it cannot be read or is no RINEX navigation file of version 3 or 4.
    """
    try:
        text = Path(path).read_text(encoding="latin-1")
    except OSError as error:
        reason = error.strerror or str(error)
        raise NavigationError(f"cannot read the navigation file {path}: {reason}") from error
    return parse_navigation(text, str(path))


def parse_navigation(text: str, name: str = "navigation file") -> Navigation:
    """Read the text of a file; see :func:`read_navigation`."""
    lines = text.split("\n")
    header = read_header(lines, name)
    contents, notes = header.contents, list(header.notes)
    left_out: Counter[str] = Counter()
    parts: list[Contents] = []
    for first, record in _records(lines, header):
        try:
            parts.append(_record(record, header, left_out))
        except MalformedError as error:
            notes.append(f"{name}, line {first + 1}: record left out: {error}")
    contents = _joined([contents, *parts])
    if len(notes) > MOST_NOTES:
        notes = [*notes[:MOST_NOTES], f"{name}: {len(notes) - MOST_NOTES} more records left out"]
    for kind, count in sorted(left_out.items()):
        notes.append(f"{name}: {count} records of {kind} are not used")
    return Navigation(**vars(contents), notes=tuple(notes))


def _joined(parts: list[Contents]) -> Contents:
    return Contents(
        ephemerides=tuple(e for p in parts for e in p.ephemerides),
        ionosphere=tuple(i for p in parts for i in p.ionosphere),
        utc=tuple(u for p in parts for u in p.utc),
        offsets=tuple(o for p in parts for o in p.offsets),
    )


def _records(lines: list[str], header: Header) -> list[tuple[int, list[str]]]:
    """Records, with the number of their first line; each begins in the first column."""
    records: list[tuple[int, list[str]]] = []
    for at in range(header.length, len(lines)):
        line = lines[at].rstrip("\r")
        begins = line.startswith(">") if header.version >= 4 else line[:1].strip() != ""
        if begins:
            records.append((at, [line]))
        elif records:
            records[-1][1].append(line)
        elif line.strip():
            records.append((at, [line]))
    return records


def _record(record: list[str], header: Header, left_out: Counter[str]) -> Contents:
    if header.version < 4:
        system = record[0][0]
        if system not in SYSTEMS:
            left_out[f"system {system}"] += 1
            return Contents()
        prn = whole(record[0][1:3], "satellite")
        message = LNAV if system == "G" else D2 if prn in GEO else D1
        return _ephemeris(message, system, prn, record)
    return _record_4(record, header, left_out)


def _record_4(record: list[str], header: Header, left_out: Counter[str]) -> Contents:
    words = record[0][1:].split()
    if len(words) < 3:
        raise MalformedError(f"'{record[0][:30]}' does not tell type, satellite and message")
    kind, satellite, message = words[:3]
    system = satellite[0]
    prn = whole(satellite[1:], "satellite")
    if system not in SYSTEMS or kind == "EOP":
        left_out["type EOP" if kind == "EOP" else f"system {system}"] += 1
        return Contents()
    if kind == "EPH" and message in rinex_orbits.LINES:
        return _ephemeris(message, system, prn, record[1:])
    if kind == "STO":
        return offset_contents(record[1:], system, header.leap)
    if kind == "ION":
        return _ionosphere(system, message, record[1:])
    if kind == "EPH":
        left_out[f"message {message[:4]}"] += 1
        return Contents()
    raise MalformedError(f"type '{kind}' is not known")


def _ephemeris(message: str, system: str, prn: int, lines: list[str]) -> Contents:
    names = rinex_orbits.LINES[message]
    lines = [line for line in lines if line.strip()]
    if rinex_orbits.SYSTEMS[message] != system or not 1 <= prn <= 63:
        raise MalformedError(f"{system}{prn:02d} does not send {message}")
    if len(lines) != len(names) + 1:
        raise MalformedError(
            f"{message} of {system}{prn:02d} has {len(lines)} lines, must have {len(names) + 1}"
        )
    if lines[0][:3].replace(" ", "0") != f"{system}{prn:02d}":
        raise MalformedError(f"'{lines[0][:3]}' is not {system}{prn:02d}")
    toc = epoch(lines[0][4:23], system)
    fields = dict(zip(("a0", "a1", "a2"), numbers(lines[0], 23, 3), strict=True))
    for line, quantities in zip(lines[1:], names, strict=True):
        values = numbers(line, 4, 4)
        fields.update({n: v for n, v in zip(quantities, values, strict=True) if n})
    return Contents(ephemerides=(rinex_orbits.ephemeris(message, prn, toc, fields),))


def _ionosphere(system: str, message: str, lines: list[str]) -> Contents:
    if len(lines) < 3:
        raise MalformedError(f"ION has {len(lines)} lines, must have 3")
    time = epoch(lines[0][4:23], system)
    v = numbers(lines[0], 23, 3) + numbers(lines[1], 4, 4) + numbers(lines[2], 4, 2)
    if message == "CNVX" and system == "C":
        bdgim = Bdgim((v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]), "C", time)
        return Contents(ionosphere=(bdgim,))
    model = Klobuchar.of(v[:8], system, time)
    return Contents(ionosphere=(model,))
