"""Which week it is, where messages tell it up to a rollover or not at all."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .time import SYSTEM_EPOCH_S, WEEK_S, GnssTime

if TYPE_CHECKING:
    from .records import Frame

ROLLOVER_WEEKS = {"G": 1024, "C": 8192}
"""IS-GPS-200, 20.3.3.3.1.1 (LNAV: 10 bits); BDS-SIS-ICD-B1I-3.0, 5.2.4.3 (13 bits)."""
EARLIEST_WEEK = {"G": 2048, "C": 0}
"""Without a date, a week number is taken for the first one from here on: GPS weeks of 2019-04-07 to
2038-11-20, BDS weeks of 2006 to 2163."""


def full_week(system: str, week: int, near: GnssTime | None, rollover: int | None = None) -> int:
    """Week that a truncated week number means: the nearest to a date."""
    modulus = rollover or ROLLOVER_WEEKS[system]
    if near is None:
        earliest = EARLIEST_WEEK[system]
        return earliest + (week - earliest) % modulus
    about = near.week_tow(system)[0]
    return about + (week - about + modulus // 2) % modulus - modulus // 2


def nearest(system: str, tow_s: float, near: GnssTime) -> GnssTime:
    """The instant of that time of week that is nearest to another one."""
    week, tow = near.week_tow(system)
    week += round((tow - tow_s) / WEEK_S)
    return GnssTime.of_week(week, tow_s, system)


def dated(frame: Frame, near: GnssTime) -> Frame:
    """A frame in the week that brings it nearest to an instant."""
    second = (frame.transmitted.seconds - SYSTEM_EPOCH_S[frame.system]) % WEEK_S
    time = nearest(frame.system, second, near) + frame.transmitted.fraction
    return replace(frame, transmitted=time, week_known=True)
