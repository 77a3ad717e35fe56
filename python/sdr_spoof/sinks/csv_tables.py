"""Fixes and observations as CSV (RFC 4180), for spreadsheets; empty where there is no value."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

from sdr_spoof.route import Alarm, Quality

from .atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.observations import Observations
    from sdr_spoof.route import Route

FIX_COLUMNS = (
    "gpst", "week", "tow_s", "latitude_deg", "longitude_deg", "height_m", "east_m_s", "north_m_s",
    "up_m_s", "sigma_east_m", "sigma_north_m", "sigma_up_m", "pdop", "hdop", "vdop", "quality",
    "alarm", "satellites_used",
)  # fmt: skip
OBSERVATION_COLUMNS = (
    "gpst", "week", "tow_s", "sample_time_s", "satellite", "signal", "pseudorange_m",
    "carrier_phase_cycles", "doppler_hz", "cn0_dbhz", "lock_lost", "half_cycle", "spoofed",
)  # fmt: skip


def write_fixes_csv(path: Path, route: Route, *, force: bool = False) -> None:
    """Write a row for each epoch, also those without a fix.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    _write(path, FIX_COLUMNS, (_fix(route, i) for i in range(len(route.times))), force=force)


def write_observations_csv(path: Path, seen: Observations, *, force: bool = False) -> None:
    """Write a row for each signal at each epoch.

    Raises:
        OutputError: as :func:`write_fixes_csv`.
    """
    _write(path, OBSERVATION_COLUMNS, _observed(seen), force=force)


def _write(path: Path, head: Iterable[str], rows: Iterable[list[Any]], *, force: bool) -> None:
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(head)
    table.writerows(rows)
    write_bytes(path, text.getvalue().encode(), force=force)


def _time(time: GnssTime) -> list[str]:
    week, tow = time.week_tow()
    date = time.calendar().replace(tzinfo=None).isoformat(timespec="microseconds")
    return [date, str(week), f"{tow:.9f}"]


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else ""


def _fix(route: Route, i: int) -> list[str]:
    numbers = [
        *((route.latitude_deg[i], 9), (route.longitude_deg[i], 9), (route.height_m[i], 4)),
        *((v, 4) for v in route.velocity_enu_m_s[i]),
        *((v, 3) for v in route.sigma_enu_m[i]),
        *((v, 2) for v in route.dop[i]),
    ]
    return [
        *_time(route.times[i]),
        *(_number(value, digits) for value, digits in numbers),
        Quality(route.quality[i]).name.lower(),
        Alarm(route.alarm[i]).name.lower(),
        " ".join(route.used(i)),
    ]


def _observed(seen: Observations) -> Iterator[list[str]]:
    for epoch in range(seen.epochs):
        head = [*_time(seen.time(epoch)), f"{seen.sample_time_s[epoch]:.9f}"]
        for i, signal in enumerate(seen.signals):
            if not math.isfinite(seen.cn0_dbhz[epoch, i]):
                continue
            yield [
                *head,
                signal.satellite,
                signal.signal,
                _number(seen.pseudorange_m[epoch, i], 4),
                _number(seen.carrier_phase_cycles[epoch, i], 4),
                _number(seen.doppler_hz[epoch, i], 4),
                _number(seen.cn0_dbhz[epoch, i], 2),
                *(str(int(f[epoch, i])) for f in (seen.lock_lost, seen.half_cycle, seen.spoofed)),
            ]
