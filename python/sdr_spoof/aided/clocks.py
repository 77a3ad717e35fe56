"""IMU and GNSS on one clock."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError

if TYPE_CHECKING:
    from sdr_spoof.aiding.records import ImuLog, Measurements
    from sdr_spoof.nav.time import GnssTime

LEAST_S = 2.0
"""Less than this in common is no overlap."""
LEAP_HINT_S = 60.0
"""Clocks that miss each other by less are probably in different time systems."""

FARTHEST_ZONE_S = 15 * 3600.0


def on_one_clock(log: ImuLog, measurements: Measurements) -> ImuLog:
    """Increments by the clock of the measurements, those long before or after left away.

    Raises:
        AidingError: the IMU's clock is not known, or both have nothing in common.
    """
    ours = measurements.reference
    if log.reference is None or ours is None:
        if log.reference is not ours:
            raise AidingError(
                "the IMU's file does not tell its time by GNSS; give the UTC that its times count "
                "from with --imu-start, such as 2023-03-12T12:00:00"
            )
        shifted = log
    else:
        shifted = replace(log, reference=ours, time_s=log.time_s + (log.reference - ours))
    if not shifted.time_s.size or not measurements.time_s.size:
        raise AidingError("there are no increments of an IMU, or no epochs of GNSS: nothing to do")
    first = max(shifted.time_s[0], measurements.time_s[0])
    last = min(shifted.time_s[-1], measurements.time_s[-1])
    if last - first < LEAST_S:
        raise AidingError(_apart(shifted, measurements, ours))
    begin, end = first - log.interval_s, last + log.interval_s
    rows = np.searchsorted(shifted.time_s, begin), np.searchsorted(shifted.time_s, end, "right")
    return shifted.part(int(rows[0]), int(rows[1]))


def _apart(log: ImuLog, measurements: Measurements, reference: GnssTime | None) -> str:
    spans = [
        f"{what} {_instant(reference, t[0])} to {_instant(reference, t[-1])}"
        for what, t in (("the IMU covers", log.time_s), ("GNSS", measurements.time_s))
    ]
    gap = max(log.time_s[0] - measurements.time_s[-1], measurements.time_s[0] - log.time_s[-1])
    late_s = float(log.time_s[0] - measurements.time_s[0])
    hint = "give files of the same drive"
    if gap < LEAP_HINT_S:
        hint = "is one of them in UTC, which is 18 s behind GPST?"
    elif gap < FARTHEST_ZONE_S and abs(late_s - round(late_s / 3600) * 3600) < LEAP_HINT_S:
        hint = "is one of them in local time?"
    return f"IMU and GNSS have nothing in common: {', '.join(spans)}; {hint}"


def _instant(reference: GnssTime | None, time_s: float) -> str:
    if reference is None:
        return f"{time_s:.1f} s"
    return f"{(reference + float(np.round(time_s, 1))).utc():%Y-%m-%d %H:%M:%S}"
