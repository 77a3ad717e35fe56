"""Orbits for a sky: which ephemeris of the file, and where its satellite is."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import NavigationError
from sdr_spoof.nav.orbit import states
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.time import GnssTime

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from sdr_spoof.nav.ephemeris import Ephemeris
    from sdr_spoof.nav.records import Navigation

    from .ranges import Orbit
    from .table import SkyTable

_EARTH_RATE = {"G": 7.2921151467e-5, "C": 7.292115e-5}
"""IS-GPS-200, table 20-IV; BDS-SIS-ICD-B1I-3.0, section 3.2."""
UNHEALTHY = {"G": 0b111111, "C": 1}
"""IS-GPS-200, 20.3.3.3.1.4: all signals bad; BDS-SIS-ICD-B1I-3.0, 5.2.4.6, and B1C, 7.14."""
LEAD_S = {"G": 7200.0, "C": 0.0}
"""Between an ephemeris' first transmission and its reference: IS-GPS-200, 20.3.4.5 (the middle of
four hours); BDS-SIS-ICD-B1I-3.0, 5.2.4.10 and 11 (new ones begin with the hour of ``toe``)."""
ISSUE_GRID_S = 90
"""Frames of all messages begin together at multiples of this of a week: 30 s and 18 s."""
DEFAULT = Path(__file__).parents[1] / "data" / "brdc-2023-03-12.rnx"
"""Broadcast orbits of GPS and BDS of 2023-03-12, 10 to 14 h (see NOTICE)."""


def navigation(table: SkyTable) -> Navigation:
    """The navigation file of a sky.

    Raises:
        ValueError: it cannot be read.
    """
    path = DEFAULT if table.navigation is None else Path(table.navigation)
    try:
        return _read(path, path.stat().st_mtime_ns)
    except OSError as error:
        raise ValueError(f"navigation: {path}: cannot be read: {error.strerror}") from error
    except NavigationError as error:
        raise ValueError(f"navigation: {error}") from error


@lru_cache(maxsize=2)
def _read(path: Path, changed: int) -> Navigation:
    del changed
    return read_navigation(path)


def chosen(
    navigation: Navigation, table: SkyTable, start: GnssTime, duration_s: float
) -> tuple[Ephemeris, ...]:
    """For each healthy satellite the ephemeris whose reference is nearest to the middle.

    It must be meant for the beginning and for the end: the orbit has no steps within a recording.

    Raises:
        ValueError: the file has none for the time.
    """
    known = [e for e in navigation.ephemerides if e.system in table.systems]
    best: dict[tuple[str, int], Ephemeris] = {}
    for ephemeris in (e for e in known if e.health == 0 and _fits(e, start, duration_s)):
        name = (ephemeris.system, ephemeris.prn)
        if name not in best or _off_s(ephemeris, start, duration_s) < _off_s(
            best[name], start, duration_s
        ):
            best[name] = ephemeris
    if not best:
        raise ValueError(_stale(table, known, start, duration_s))
    return tuple(_as_sent(e, table) for e in best.values())


def issues(
    navigation: Navigation, table: SkyTable, main: Ephemeris
) -> tuple[tuple[GnssTime, Ephemeris], ...]:
    """From when a satellite sends which ephemeris, in order; the first also before its time.

    ``main`` is that of its orbit; those of the other messages and unhealthy ones are left out.
    """
    if not table.new_issues:
        return ((_begin(main), main),)
    same = (main.system, main.prn, main.message)
    known = {
        _begin(e): e
        for e in navigation.ephemerides
        if (e.system, e.prn, e.message) == same and e.health == 0
    }
    return tuple((begin, _as_sent(known[begin], table)) for begin in sorted(known))


def _begin(e: Ephemeris) -> GnssTime:
    """When it is sent first, on a boundary of all messages' frames."""
    week, tow = (e.toe + -LEAD_S[e.system]).week_tow(e.system)
    return GnssTime.of_week(week, -(-tow // ISSUE_GRID_S) * ISSUE_GRID_S, e.system)


def _as_sent(ephemeris: Ephemeris, table: SkyTable) -> Ephemeris:
    """With the health that the satellite is to tell."""
    healthy = table.override(ephemeris.system, ephemeris.prn).healthy
    return ephemeris if healthy else replace(ephemeris, health=UNHEALTHY[ephemeris.system])


def _off_s(ephemeris: Ephemeris, start: GnssTime, duration_s: float) -> float:
    return abs(start - ephemeris.toe + 0.5 * duration_s)


def _fits(ephemeris: Ephemeris, start: GnssTime, duration_s: float) -> bool:
    return _off_s(ephemeris, start, duration_s) + 0.5 * duration_s <= ephemeris.fit_interval_s


def _stale(table: SkyTable, known: Iterable[Ephemeris], start: GnssTime, duration_s: float) -> str:
    times = sorted(e.toe for e in known)
    file = table.navigation or "the navigation file that comes with the package"
    if not times:
        return f"navigation: {file} has no orbits of {', '.join(table.systems)}; give another"
    return (
        f"start: {file} has no orbit for {start.utc():%Y-%m-%d %H:%M:%S} UTC and "
        f"{duration_s:g} s from then; its orbits are for {times[0].utc():%Y-%m-%d %H:%M} to "
        f"{times[-1].utc():%Y-%m-%d %H:%M} UTC: change start, shorten duration_s, or give the "
        "navigation of that day"
    )


def orbit(ephemeris: Ephemeris, start: GnssTime) -> Orbit:
    """Places and clocks of a satellite by seconds of system time since the start."""

    def at(time_s: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        found = states([ephemeris], np.zeros(time_s.size, np.int64), time_s, start)
        return found.position_m, found.clock_s

    return at


def earth_rate(ephemeris: Ephemeris) -> float:
    """Rotation of the Earth in rad/s, as the satellite's system has it."""
    return _EARTH_RATE[ephemeris.system]
