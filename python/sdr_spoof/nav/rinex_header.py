"""Header of RINEX navigation files; that of version 3 has ionosphere and time offsets."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..errors import NavigationError
from .broadcast import Contents, Klobuchar
from .rinex_lines import MalformedError, number, whole
from .rinex_offsets import Leap, parameters
from .time import GnssTime
from .weeks import full_week

LABEL = 60
"""Column at which a line's label begins."""
LEAP = "LEAP SECONDS"
"""Read first: offsets against UTC need it."""
IONOSPHERE = {"GPS": "G", "BDS": "C"}


@dataclass(frozen=True)
class Header:
    """What the header says."""

    version: float
    length: int
    """Lines."""
    leap: Leap | None
    contents: Contents = field(default_factory=Contents)
    notes: tuple[str, ...] = ()


def read_header(lines: list[str], name: str) -> Header:
    """Read it.

    Raises:
        NavigationError: if the lines do not begin as a navigation file of version 3 or 4.
    """
    version = _version(lines[0], name)
    ends = (n for n, line in enumerate(lines) if line[LABEL:].startswith("END OF HEADER"))
    end = next(ends, None)
    if end is None:
        raise NavigationError(
            f"{name} has no 'END OF HEADER': it is cut off or no RINEX file; fetch it again"
        )
    leap: Leap | None = None
    alpha_beta: dict[str, tuple[float, float, float, float]] = {}
    contents, notes = Contents(), []
    for n, line in sorted(enumerate(lines[:end]), key=lambda item: LEAP not in item[1][LABEL:]):
        label = line[LABEL:].strip()
        try:
            if label == LEAP:
                leap = _leap(line)
            elif label == "IONOSPHERIC CORR":
                v = [number(line[at : at + 12]) for at in range(5, 53, 12)]
                alpha_beta[line[:4]] = (v[0], v[1], v[2], v[3])
            elif label == "TIME SYSTEM CORR":
                contents += _time_system(line, leap)
        except MalformedError as error:
            notes.append(f"{name}, line {n + 1}: header line left out: {error}")
    models = [
        Klobuchar(alpha_beta[f"{mark}A"], alpha_beta[f"{mark}B"], system)
        for mark, system in IONOSPHERE.items()
        if f"{mark}A" in alpha_beta and f"{mark}B" in alpha_beta
    ]
    contents += Contents(ionosphere=tuple(models))
    return Header(version, end + 1, leap, contents, tuple(notes))


def _version(line: str, name: str) -> float:
    if "RINEX VERSION" not in line[LABEL:]:
        raise NavigationError(
            f"{name} does not begin with 'RINEX VERSION / TYPE': give a RINEX navigation file"
        )
    try:
        version = number(line[:9])
    except MalformedError:
        version = 0.0
    if line[20:21].upper() != "N" or not 3.0 <= version < 5.0:
        raise NavigationError(
            f"{name} is RINEX {line[:9].strip()} of type '{line[20:21]}'; give a navigation file "
            f"('N') of version 3 or 4"
        )
    return version


def _leap(line: str) -> Leap:
    now = whole(line[:6], "leap second count")
    future = whole(line[6:12], "leap seconds") if line[6:12].strip() else now
    week = whole(line[12:18], "week") if line[12:18].strip() else 0
    day = whole(line[18:24], "day") if line[18:24].strip() else 0
    return Leap(now, future, week, day, "C" if line[24:27] == "BDS" else "G")


def _time_system(line: str, leap: Leap | None) -> Contents:
    code, a0, a1 = line[:4], number(line[5:22]), number(line[22:38])
    system = {"GP": "G", "BD": "C"}.get(code[:2])
    if system is None:
        return Contents()
    week = whole(line[45:50], "week") if line[45:50].strip() else 0
    # Files give the week of the system with or without rollovers, or, for BDS, that of GPS.
    tow = number(line[38:45])
    if system == "G" and 0 < week < 1024:
        week = full_week("G", week, None)
    if not 0 <= week < 20_000 or not 0 <= tow <= 700_000:
        raise MalformedError(f"week {week}, second {tow:g} is not a time of reference")
    reference = GnssTime.of_week(week, tow, system)
    return parameters(code, (a0, a1, 0.0), reference, None, leap)
