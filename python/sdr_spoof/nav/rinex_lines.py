"""Lines of RINEX navigation files: numbers in columns, both ways."""

from __future__ import annotations

import math
from datetime import datetime

from .time import GnssTime

WIDTH = 19
"""Of a number, D19.12."""


class MalformedError(ValueError):
    """A line that cannot be read; told as a note, never raised to the user."""


def number(text: str) -> float:
    """Read a number in Fortran's notation; blank is 0."""
    text = text.strip().replace("D", "E").replace("d", "e")
    if not text:
        return 0.0
    try:
        value = float(text)
    except ValueError:
        raise MalformedError(f"'{text[:20]}' is not a number") from None
    if not math.isfinite(value):
        raise MalformedError(f"'{text}' is not a finite number")
    return value


def whole(text: str, what: str) -> int:
    """Read a whole number."""
    try:
        return int(text)
    except ValueError:
        raise MalformedError(f"{what} '{text.strip()[:20]}' is not a whole number") from None


def numbers(line: str, first: int, count: int) -> list[float]:
    """Read so many numbers from a column on; those beyond the end of the line are 0."""
    return [number(line[at : at + WIDTH]) for at in range(first, first + WIDTH * count, WIDTH)]


def epoch(text: str, system: str) -> GnssTime:
    """Read ``yyyy mm dd hh mm ss`` in a system's own time."""
    parts = text.split()
    if len(parts) != 6:
        raise MalformedError(f"'{text.strip()[:25]}' is not a date")
    year, month, day, hour, minute, second = (whole(p, "date") for p in parts)
    try:
        date = datetime(year, month, day, hour, minute, min(second, 59))
        time = GnssTime.of_calendar(date, system) + (second - min(second, 59))
    except (ValueError, OverflowError):
        raise MalformedError(f"'{text.strip()[:25]}' is not a date") from None
    if not 1980 <= year <= 2200:
        raise MalformedError(f"year {year} is before GPS or far in the future")
    return time


def written(value: float) -> str:
    """Write a number in 19 columns."""
    return f"{0.0 if math.isnan(value) else value:19.12E}"


def written_epoch(time: GnssTime, system: str) -> str:
    """Write a date, whole seconds."""
    return f"{time.calendar(system):%Y %m %d %H %M %S}"


def line(values: list[float], indent: int = 4) -> str:
    """Write a line of numbers."""
    return " " * indent + "".join(written(v) for v in values)
