"""Instants in GNSS time, exact to far below a nanosecond over decades."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

WEEK_S = 604_800
GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
SYSTEM_EPOCH_S = {"G": 0, "J": 0, "E": 0, "C": 1356 * WEEK_S + 14}
"""Start of week 0 of each system's time, in GPST: BDT began on 2006-01-01 UTC and is 14 s behind
GPST (BDS-SIS-ICD-B1I-3.0, section 3.3). Galileo weeks are counted as in RINEX, as those of GPS."""
LEAP_SECONDS = (
    (datetime(1999, 1, 1, tzinfo=UTC), 13),
    (datetime(2006, 1, 1, tzinfo=UTC), 14),
    (datetime(2009, 1, 1, tzinfo=UTC), 15),
    (datetime(2012, 7, 1, tzinfo=UTC), 16),
    (datetime(2015, 7, 1, tzinfo=UTC), 17),
    (datetime(2017, 1, 1, tzinfo=UTC), 18),
)
"""GPST minus UTC from each date on (IERS Bulletin C)."""


@dataclass(frozen=True, order=True)
class GnssTime:
    """An instant: GPST since 1980-01-06 as whole seconds and a fraction.

    One float would not do: seconds of a week alone have a resolution of 3 cm at the speed of light.
    """

    seconds: int
    fraction: float = 0.0
    """In [0, 1)."""

    def __post_init__(self) -> None:
        """Refuse what is not normalised."""
        if not 0.0 <= self.fraction < 1.0:
            raise ValueError(f"fraction {self.fraction} must be in [0, 1)")

    @classmethod
    def of_week(cls, week: int, tow_s: float, system: str = "G") -> GnssTime:
        """The instant at a time of week of a system's own time (RINEX system letter)."""
        whole = math.floor(tow_s)
        return cls(SYSTEM_EPOCH_S[system] + week * WEEK_S + whole, tow_s - whole)

    def week_tow(self, system: str = "G") -> tuple[int, float]:
        """Week, not rolled over, and time of week in a system's own time."""
        week, second = divmod(self.seconds - SYSTEM_EPOCH_S[system], WEEK_S)
        return week, second + self.fraction

    def __add__(self, seconds: float) -> GnssTime:
        """So many seconds later."""
        whole = math.floor(seconds)
        fraction = self.fraction + (seconds - whole)
        carry = math.floor(fraction)
        return GnssTime(self.seconds + whole + carry, fraction - carry)

    def __sub__(self, other: GnssTime) -> float:
        """Seconds since another instant."""
        return (self.seconds - other.seconds) + (self.fraction - other.fraction)

    @classmethod
    def of_utc(cls, utc: datetime) -> GnssTime:
        """From a calendar date in UTC (naive ones are taken to be)."""
        utc = utc if utc.tzinfo else utc.replace(tzinfo=UTC)
        whole = utc.replace(microsecond=0)
        seconds = (whole - GPS_EPOCH) // timedelta(seconds=1)
        return cls(seconds + leap_seconds(utc), utc.microsecond * 1e-6)

    def utc(self) -> datetime:
        """Calendar date in UTC, to a microsecond."""
        leap = leap_seconds(GPS_EPOCH + timedelta(seconds=self.seconds))
        # A second time with the date found: the table is in UTC.
        leap = leap_seconds(GPS_EPOCH + timedelta(seconds=self.seconds - leap))
        return GPS_EPOCH + timedelta(seconds=self.seconds - leap, microseconds=self.fraction * 1e6)

    def calendar(self, system: str = "G") -> datetime:
        """Calendar date in a system's own time, as RINEX files have it (no leap seconds)."""
        behind_s = 14 if system == "C" else 0
        return GPS_EPOCH + timedelta(
            seconds=self.seconds - behind_s, microseconds=self.fraction * 1e6
        )

    @classmethod
    def of_calendar(cls, date: datetime, system: str = "G") -> GnssTime:
        """From a calendar date in a system's own time; the opposite of :meth:`calendar`."""
        date = date if date.tzinfo else date.replace(tzinfo=UTC)
        whole = date.replace(microsecond=0)
        seconds = (whole - GPS_EPOCH) // timedelta(seconds=1)
        return cls(seconds + (14 if system == "C" else 0), date.microsecond * 1e-6)


def leap_seconds(utc: datetime) -> int:
    """GPST minus UTC, in s, at a date from 1999 on; the last known one for later dates."""
    return next((n for date, n in reversed(LEAP_SECONDS) if utc >= date), LEAP_SECONDS[0][1])
