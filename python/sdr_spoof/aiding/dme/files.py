"""CSV files of DME ranges and of INS solutions.

Both have a line with the names of the columns; lines that begin with # are comments, other columns
are left alone. Time: ``gps_week`` and ``gps_tow_s``, or ``time_s`` since an instant that the reader
is told. DME: ``station`` (a name), its ``latitude_deg``, ``longitude_deg``, ``height_m``, and
``range_m``, one row a range. INS: ``latitude_deg``, ``longitude_deg``, ``height_m`` and, if known,
``velocity_north_m_s``, ``velocity_east_m_s``, ``velocity_down_m_s`` and ``yaw_deg``, ``pitch_deg``,
``roll_deg``.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.errors import AidingError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix, geodetic_to_ecef
from sdr_spoof.nav.time import WEEK_S, GnssTime

from .records import DmeLog
from .stations import Station

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

GPS_TIME, TIME = ("gps_week", "gps_tow_s"), ("time_s",)
PLACE = ("latitude_deg", "longitude_deg", "height_m")
VELOCITY = ("velocity_north_m_s", "velocity_east_m_s", "velocity_down_m_s")
ATTITUDE = ("yaw_deg", "pitch_deg", "roll_deg")


def read_dme(path: Path | str, start: GnssTime | None = None) -> DmeLog:
    """Slant ranges of a file; rows without a number are left out.

    Args:
        path: of the file.
        start: what a column ``time_s`` counts from.

    Raises:
        AidingError: it cannot be read, a column is missing, a row is wrong, one name stands for
            two places.
    """
    table = _Table(Path(path), ("station", *PLACE, "range_m"))
    reference, time_s = table.time(start)
    names = table.words("station")
    place, range_m = table.numbers(PLACE), table.numbers(("range_m",))[:, 0]
    stations: dict[str, Station] = {}
    for name, where in zip(names, place.tolist(), strict=True):
        made = Station(name, *where)
        if stations.setdefault(name, made) != made:
            raise AidingError(f"{path}: station '{name}' has two places; give each its own name")
    if (range_m <= 0.0).any():
        raise AidingError(f"{path}: a slant range is not above 0 m; leave such rows out")
    order = list(stations)
    kept = np.isfinite(range_m) & np.isfinite(time_s)
    rows = np.flatnonzero(kept)[np.argsort(time_s[kept], kind="stable")]
    which = np.array([order.index(name) for name in names], dtype=np.int64)
    return DmeLog(reference, tuple(stations.values()), time_s[rows], which[rows], range_m[rows])


def read_ins(path: Path | str, start: GnssTime | None = None) -> InertialStates:
    """States of a file; velocity and attitude are NaN where it has none.

    Raises:
        AidingError: it cannot be read, a column is missing, a row is wrong, or times do not ascend.
    """
    table = _Table(Path(path), PLACE)
    reference, time_s = table.time(start)
    place = table.numbers(PLACE)
    nothing = np.full(place.shape, np.nan)
    moving = table.numbers(VELOCITY) if table.has(VELOCITY) else nothing
    turned = np.radians(table.numbers(ATTITUDE)) if table.has(ATTITUDE) else nothing
    bad = ~np.isfinite(np.column_stack([time_s, place])).all(axis=1)
    if bad.any():
        raise AidingError(
            f"{path}: row {int(np.argmax(bad)) + 1} has no time or place; leave such rows out"
        )
    if (np.diff(time_s) <= 0.0).any():
        raise AidingError(f"{path}: times do not ascend; sort the rows and leave out what repeats")
    axes = np.stack([enu_matrix(*p[:2]) for p in place])
    east_north_up = moving[:, [1, 0, 2]] * (1.0, 1.0, -1.0)
    velocity = np.einsum("nk,nkx->nx", east_north_up, axes)
    return InertialStates(
        reference, time_s, geodetic_to_ecef(place), velocity, turned, np.zeros(time_s.size)
    )


def dme_text(log: DmeLog) -> str:
    """The CSV of some ranges."""
    lines = [",".join([*_time_names(log.reference), "station", *PLACE, "range_m"])]
    for time, which, range_m in zip(log.time_s, log.station, log.range_m, strict=True):
        s = log.stations[which]
        place = f"{s.latitude_deg:.9f},{s.longitude_deg:.9f},{s.height_m:.3f}"
        lines.append(f"{_time_text(log.reference, float(time))},{s.name},{place},{range_m:.3f}")
    return "\n".join(lines) + "\n"


def ins_text(states: InertialStates) -> str:
    """The CSV of some states."""
    names = [*_time_names(states.reference), *PLACE, *VELOCITY, *ATTITUDE]
    lines = [",".join(names)]
    places = ecef_to_geodetic(states.position_m)
    for k, place in enumerate(places):
        east, north, up = enu_matrix(*place[:2]) @ states.velocity_m_s[k]
        numbers = [*(f"{v:.10f}" for v in place[:2]), f"{place[2]:.4f}"]
        numbers += [f"{v:.5f}" for v in (north, east, -up)]
        numbers += [f"{v:.6f}" for v in np.degrees(states.attitude_rad[k])]
        lines.append(",".join([_time_text(states.reference, float(states.time_s[k])), *numbers]))
    return "\n".join(lines) + "\n"


def _time_names(reference: GnssTime | None) -> tuple[str, ...]:
    return TIME if reference is None else GPS_TIME


def _time_text(reference: GnssTime | None, time_s: float) -> str:
    if reference is None:
        return f"{time_s:.6f}"
    week, tow_s = (reference + time_s).week_tow()
    return f"{week},{tow_s:.6f}"


class _Table:
    """Rows of a CSV file by the names of its columns."""

    def __init__(self, path: Path, wanted: Sequence[str]) -> None:
        self._path = path
        try:
            text = path.read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise AidingError(f"{path}: cannot be read: {error}") from error
        lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
        rows = list(csv.reader(lines))
        names = [n.strip() for n in rows[0]] if rows else []
        self._column = {name: k for k, name in enumerate(names)}
        self._rows = rows[1:]
        missing = [n for n in wanted if n not in self._column]
        if not (self.has(GPS_TIME) or self.has(TIME)):
            missing.append("gps_week and gps_tow_s, or time_s")
        if missing:
            raise AidingError(f"{path}: has no column {', '.join(missing)}; add it")
        if not self._rows:
            raise AidingError(f"{path}: has no rows below the names of its columns")

    def has(self, names: Sequence[str]) -> bool:
        return all(n in self._column for n in names)

    def words(self, name: str) -> list[str]:
        return [self._cell(number, name) for number in range(len(self._rows))]

    def numbers(self, names: Sequence[str]) -> NDArray[np.float64]:
        found = np.empty((len(self._rows), len(names)))
        for number in range(len(self._rows)):
            for k, name in enumerate(names):
                cell = self._cell(number, name)
                try:
                    found[number, k] = float(cell) if cell else np.nan
                except ValueError as error:
                    raise AidingError(
                        f"{self._path}: row {number + 1}: {name} is '{cell}', not a number"
                    ) from error
        return found

    def time(self, start: GnssTime | None) -> tuple[GnssTime | None, NDArray[np.float64]]:
        """What times count from, and the times."""
        if not self.has(GPS_TIME):
            return start, self.numbers(TIME)[:, 0]
        week, tow_s = self.numbers(GPS_TIME).T
        if not np.isfinite([week[0], tow_s[0]]).all():
            raise AidingError(f"{self._path}: row 1 has no time; leave such rows out")
        whole = float(np.floor(tow_s[0]))
        return GnssTime.of_week(int(week[0]), whole), (week - week[0]) * WEEK_S + tow_s - whole

    def _cell(self, number: int, name: str) -> str:
        try:
            return self._rows[number][self._column[name]].strip()
        except IndexError as error:
            raise AidingError(
                f"{self._path}: row {number + 1} is too short; give a value for each column"
            ) from error
