"""Instants as people write them."""

from __future__ import annotations

import re
from datetime import UTC, datetime

from .time import GnssTime

_WEEK = re.compile(r"(GPS|GPST|BDT)\s+(\d+)\s+([\d.]+)")


def instant(text: str) -> GnssTime:
    """A date in UTC (``2023-03-12T12:00:00``), or week and seconds: ``BDT 897 43204``.

    Raises:
        ValueError: it is neither.
    """
    week = _WEEK.fullmatch(text.strip())
    if week:
        system = "C" if week[1] == "BDT" else "G"
        return GnssTime.of_week(int(week[2]), float(week[3]), system)
    try:
        date = datetime.fromisoformat(text)
    except ValueError as error:
        raise ValueError(
            f"start: '{text}' is neither a date such as 2023-03-12T12:00:00 nor week and seconds "
            "such as 'BDT 897 43204'"
        ) from error
    return GnssTime.of_utc(date.astimezone(UTC) if date.tzinfo else date)
