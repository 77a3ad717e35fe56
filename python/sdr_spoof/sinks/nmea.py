"""NMEA 0183 (4.11): GGA, RMC, GSA and GSV for every epoch, by pynmeagps.

The talker is the system of the satellites used (GB for BeiDou, GP, GA), GN for several. GSV go by
system and signal. Altitudes are above the geoid of EGM2008 by a coarse table (0.2 m rms, see
:mod:`sdr_spoof.nav.geoid`); altitude plus separation is the height above the ellipsoid, to 0.01 m.
The navigational status of RMC tells what the detectors say: S (safe), C (caution: a satellite
was under suspicion or left out as spoofed), U (unsafe: the fix contradicts itself, or rests on
satellites under suspicion while others are spoofed).
"""

from __future__ import annotations

import math
from collections import defaultdict
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np
from pynmeagps import GET, NMEAMessage

from sdr_spoof.nav.geoid import geoid_height_m
from sdr_spoof.route import Alarm, Quality

from .atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from sdr_spoof.route import Route, SatelliteView

TALKERS = {"G": "GP", "C": "GB", "E": "GA", "J": "GQ", "S": "GP"}
"""Talker of each system by its RINEX letter."""
SYSTEM_IDS = {"G": "1", "E": "3", "C": "4", "J": "5", "S": "1"}
"""GNSS system identifiers of GSA (NMEA 0183 4.11)."""
SIGNAL_IDS = {"L1CA": "1", "B1I": "1", "B1CP": "3", "B1CD": "3", "E5AQ": "1", "E5BQ": "2"}
"""Signal identifiers of GSV."""
IN_GSA, IN_GSV = 12, 4
KNOTS = 3600.0 / 1852.0
"""Knots of one m/s."""


def write_nmea(path: Path, route: Route, *, force: bool = False) -> None:
    """Write the sentences of every epoch, also those without a fix.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    epochs = range(len(route.times))
    content = b"".join(m.serialize() for i in epochs for m in sentences(route, i))
    write_bytes(path, content, force=force)


def sentences(route: Route, epoch: int) -> Iterator[NMEAMessage]:
    """Sentences of one epoch."""
    used = [s for s in route.satellites if s.used[epoch]]
    systems = sorted({s.name[0] for s in used})
    talker = TALKERS[systems[0]] if len(systems) == 1 else "GN"
    yield _message(talker, "GGA", _gga(route, epoch, len(used)))
    yield _message(talker, "RMC", _rmc(route, epoch))
    for system in systems:
        for fields in _gsa(route, epoch, system, used):
            yield _message(talker, "GSA", fields)
    for viewed_by, fields in _gsv(route, epoch):
        yield _message(viewed_by, "GSV", fields)


def _clock(route: Route, epoch: int) -> str:
    return f"{route.times[epoch].utc():%H%M%S.%f}"[:9]


def _place(route: Route, epoch: int) -> list[str]:
    if not route.fixed[epoch]:
        return [""] * 4
    latitude, longitude = float(route.latitude_deg[epoch]), float(route.longitude_deg[epoch])
    return [
        _minutes(latitude, 2),
        "N" if latitude >= 0 else "S",
        _minutes(longitude, 3),
        "E" if longitude >= 0 else "W",
    ]


def _minutes(degrees: float, digits: int) -> str:
    """Degrees and minutes, to 2 mm; sentences must stay within 82 characters."""
    whole, minutes = divmod(round(abs(degrees) * 60e6), 60 * 10**6)
    return f"{whole:0{digits}d}{minutes // 10**6:02d}.{minutes % 10**6:06d}"


def _gga(route: Route, epoch: int, used: int) -> list[str]:
    values = ["0", "00", "", "", "", "", ""]
    if route.fixed[epoch]:
        geoid = geoid_height_m(route.latitude_deg[epoch], route.longitude_deg[epoch])
        separation = round(float(geoid), 1)
        altitude = f"{route.height_m[epoch] - separation:.2f}"
        head = ["1", f"{used:02d}", _two(route.dop[epoch, 1])]
        values = [*head, altitude, "M", f"{separation:.1f}", "M"]
    return [_clock(route, epoch), *_place(route, epoch), *values, "", ""]


def _rmc(route: Route, epoch: int) -> list[str]:
    fixed = bool(route.fixed[epoch])
    east, north = (float(v) for v in route.velocity_enu_m_s[epoch, :2])
    motion = ["", ""]
    if fixed and math.isfinite(east):
        course = math.degrees(math.atan2(east, north)) % 360.0
        motion = [f"{math.hypot(east, north) * KNOTS:.3f}", f"{course:.2f}"]
    date = f"{route.times[epoch].utc():%d%m%y}"
    status = ["A" if fixed else "V", *_place(route, epoch), *motion, date, "", ""]
    return [_clock(route, epoch), *status, "A" if fixed else "N", _status(route, epoch)]


def _status(route: Route, epoch: int) -> str:
    if route.quality[epoch] == Quality.NONE:
        return "V"
    if route.quality[epoch] == Quality.SUSPECT:
        return "U"
    return "S" if route.alarm[epoch] == Alarm.NONE else "C"


def _gsa(route: Route, epoch: int, system: str, used: list[SatelliteView]) -> Iterator[list[str]]:
    names = [s.name for s in used if s.name[0] == system]
    fixed = bool(route.fixed[epoch])
    dops = [_two(v) if fixed else "" for v in route.dop[epoch]]
    for i in range(0, max(len(names), 1), IN_GSA):
        numbers = [_number(x) for x in names[i : i + IN_GSA]]
        numbers += [""] * (IN_GSA - len(numbers))
        yield ["A", "3" if fixed else "1", *numbers, *dops, SYSTEM_IDS[system]]


def _gsv(route: Route, epoch: int) -> Iterator[tuple[str, list[str]]]:
    """Satellites in view, by system and signal, with their talker."""
    groups: dict[tuple[str, str], dict[str, list[str]]] = defaultdict(dict)
    for satellite in route.satellites:
        for signal, values in satellite.cn0_dbhz.items():
            cn0 = float(values[epoch])
            if signal in SIGNAL_IDS and math.isfinite(cn0):
                key = satellite.name[0], SIGNAL_IDS[signal]
                groups[key].setdefault(satellite.name, _view(satellite, epoch, cn0))
    for (system, signal_id), members in sorted(groups.items()):
        rows = list(members.values())
        count = -(-len(rows) // IN_GSV)
        for number in range(count):
            part = chain.from_iterable(rows[number * IN_GSV : (number + 1) * IN_GSV])
            head = [str(count), str(number + 1), f"{len(rows):02d}"]
            yield TALKERS[system], [*head, *part, signal_id]


def _view(satellite: SatelliteView, epoch: int, cn0: float) -> list[str]:
    elevation, azimuth = satellite.elevation_deg[epoch], satellite.azimuth_deg[epoch]
    angles = ["", ""]
    if np.isfinite((elevation, azimuth)).all():
        angles = [f"{round(elevation):02d}", f"{round(azimuth) % 360:03d}"]
    return [_number(satellite.name), *angles, f"{round(cn0):02d}"]


def _number(name: str) -> str:
    """Satellite number of NMEA: SBAS PRN 120, S20 in RINEX, is 33."""
    number = int(name[1:])
    return f"{number + 13 if name[0] == 'S' else number:02d}"


def _two(value: float) -> str:
    return f"{min(float(value), 99.99):.2f}"


def _message(talker: str, kind: str, fields: list[str]) -> NMEAMessage:
    return NMEAMessage(talker, kind, GET, payload=fields)
