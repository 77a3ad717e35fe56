"""IMU data as CSV, with units in the names of the columns.

``gyro_x_rad_s``, ``_deg_s`` (rates) or ``gyro_x_rad``, ``_deg`` (increments), and likewise y and z;
``accel_x_m_s2``, ``_g``, ``_mg`` (specific forces) or ``accel_x_m_s``, ``_g_s`` (increments). Time:
``gps_week`` and ``gps_tow_s``; ``unix_s`` (UTC); or ``time_s``, which counts from ``start`` of the
configuration. The time of an increment is the end of its interval, that of a rate its instant.
Other columns are left alone; lines that begin with # are comments. One of them may tell where the
antenna is: ``# lever_arm_m = 1.2, 0, -2.5``, forward, right, down.
"""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import InertialError, OutputError
from sdr_spoof.nav.instants import instant
from sdr_spoof.nav.time import GPS_EPOCH, WEEK_S, GnssTime, leap_seconds

from ..rows import ACCEL_UNITS, GYRO_UNITS, ImuRows
from .reader import Reader, text_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from ...records import ImuLog
    from ..config import ImuConfig
    from ..rows import Unit

_SENSOR = re.compile(r"(gyro|accel)_([xyz])_(\w+)")
_LEVER_ARM = re.compile(r"#\s*lever_arm_m\s*[=:](.*)")
_TIMES = (("gps_week", "gps_tow_s"), ("unix_s",), ("time_s",))
_LAST_S = 4e9
"""Of dates since 1970: the year 2096."""
_UNIX_GPS_S = int(GPS_EPOCH.timestamp())


def read(path: Path, config: ImuConfig) -> ImuRows:
    """A table.

    Raises:
        InertialError: columns are missing, of unknown or mixed units, or a row is wrong.
    """
    every = text_of(path).splitlines()
    lines = [line for line in every if line and not line.startswith("#")]
    names = [name.strip() for name in lines[0].split(",")] if lines else []
    gyro, gyro_unit = _sensor(path, names, "gyro", GYRO_UNITS)
    accel, accel_unit = _sensor(path, names, "accel", ACCEL_UNITS)
    if gyro_unit.increment != accel_unit.increment:
        raise InertialError(
            f"{path}: gyros are in {gyro_unit.name} and accelerometers in {accel_unit.name}: give "
            "both as rates or both as increments"
        )
    times = next((t for t in _TIMES if all(n in names for n in t)), None)
    if times is None:
        raise InertialError(
            f"{path}: has no time: name a column time_s or unix_s, or two gps_week and gps_tow_s"
        )
    values = _numbers(path, lines[1:], names, (*times, *gyro, *accel))
    reference, time_s = _time(path, values[:, : len(times)], times, config)
    return ImuRows(
        origin=str(path),
        reference=reference,
        time_s=time_s,
        gyro=values[:, -6:-3] * gyro_unit.size,
        accel=values[:, -3:] * accel_unit.size,
        gyro_unit=gyro_unit,
        accel_unit=accel_unit,
        lever_arm_m=_lever_arm(path, every),
    )


def _lever_arm(path: Path, lines: list[str]) -> tuple[float, float, float] | None:
    """Of a comment, where one tells it."""
    told = next((m[1] for m in map(_LEVER_ARM.fullmatch, lines) if m), None)
    if told is None:
        return None
    try:
        forward, right, down = (float(word) for word in told.split(","))
    except ValueError as error:
        raise InertialError(
            f"{path}: '# lever_arm_m ={told}' is not three numbers in m: give forward, right, down"
        ) from error
    return forward, right, down


def _sensor(
    path: Path, names: list[str], kind: str, units: Sequence[Unit]
) -> tuple[list[str], Unit]:
    """Names of the columns x, y, z of one sensor, and their unit."""
    found = {m[2]: (m[0], m[3]) for m in map(_SENSOR.fullmatch, names) if m and m[1] == kind}
    known = {u.name: u for u in units}
    if set(found) != set("xyz"):
        raise InertialError(
            f"{path}: needs columns {kind}_x_UNIT, {kind}_y_UNIT and {kind}_z_UNIT with one of the "
            f"units {', '.join(known)}; it has {', '.join(names) or 'none'}"
        )
    columns, of = zip(*(found[axis] for axis in "xyz"), strict=True)
    if len(set(of)) > 1:
        raise InertialError(f"{path}: {', '.join(columns)} differ in their unit; bring them to one")
    if of[0] not in known:
        raise InertialError(
            f"{path}: {columns[0]}: unknown unit '{of[0]}'; known: {', '.join(known)}"
        )
    return list(columns), known[of[0]]


def _numbers(
    path: Path, lines: list[str], names: list[str], wanted: tuple[str, ...]
) -> NDArray[np.float64]:
    if not lines:
        raise InertialError(f"{path}: has no rows below the names of its columns")
    columns = [names.index(n) for n in wanted]
    try:
        return np.loadtxt(lines, delimiter=",", usecols=columns, ndmin=2, comments=None)
    except ValueError as error:
        raise InertialError(
            f"{path}: {_first_bad(lines, columns)}; give one number for each column, nan where "
            "there is none"
        ) from error


def _first_bad(lines: list[str], columns: list[int]) -> str:
    for number, line in enumerate(lines, 1):
        cells = line.split(",")
        try:
            [float(cells[c]) for c in columns]
        except (ValueError, IndexError):
            return f"row {number} is not all numbers ('{line[:60]}')"
    return "rows are not all numbers"


def _time(
    path: Path, values: NDArray[np.float64], names: tuple[str, ...], config: ImuConfig
) -> tuple[GnssTime | None, NDArray[np.float64]]:
    """What the times count from, and the times."""
    first = values[0]
    if names == ("time_s",):
        reference = None if config.start is None else _start(config.start)
        return reference, values[:, 0]
    if not np.isfinite(first).all():
        return None, values[:, -1]
    if not (np.abs(first) < _LAST_S).all():
        raise InertialError(
            f"{path}: {', '.join(names)} of {first.max():g} is no date: are the times milliseconds "
            "or nanoseconds? Give seconds"
        )
    if names == ("unix_s",):
        date = GPS_EPOCH.fromtimestamp(float(first[0]), GPS_EPOCH.tzinfo)
        whole = int(np.floor(first[0]))
        reference = GnssTime(whole - _UNIX_GPS_S + leap_seconds(date))
        return reference, values[:, 0] - whole
    week, tow_s = int(first[0]), float(np.floor(first[1]))
    time_s = (values[:, 0] - week) * WEEK_S + (values[:, 1] - tow_s)
    return GnssTime.of_week(week, tow_s), time_s


def _start(text: str) -> GnssTime:
    try:
        return instant(text)
    except ValueError as error:
        raise InertialError(f"[imu] {error}") from error


def write(path: Path, log: ImuLog) -> None:
    """Write increments as such a table.

    With ``reference`` its times are GPS week and time of week, to a nanosecond.

    Raises:
        OutputError: it cannot be written.
    """
    try:
        path.write_text(text(log), encoding="ascii")
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from error


def text(log: ImuLog, lever_arm_m: tuple[float, float, float] | None = None) -> str:
    """The table of some increments, and where the antenna is, if it is known."""
    names = ["gyro_x_rad", "gyro_y_rad", "gyro_z_rad"]
    names += ["accel_x_m_s", "accel_y_m_s", "accel_z_m_s"]
    numbers = [log.rotation_rad, log.velocity_m_s]
    if log.reference is None:
        columns, formats = [log.time_s[:, None]], ["%.9f"]
        names = ["time_s", *names]
    else:
        week, tow_s = log.reference.week_tow()
        seconds = tow_s + log.time_s
        later = np.floor(seconds / WEEK_S)
        columns, formats = [np.stack([week + later, seconds - later * WEEK_S], -1)], ["%d", "%.9f"]
        names = ["gps_week", "gps_tow_s", *names]
    table = io.StringIO()
    row = ",".join([*formats, *["%.12e"] * 6])
    np.savetxt(table, np.hstack([*columns, *numbers]), row, header=",".join(names), comments="")
    if lever_arm_m is None:
        return table.getvalue()
    return f"# lever_arm_m = {', '.join(f'{v:g}' for v in lever_arm_m)}\n{table.getvalue()}"


READER = Reader(
    "csv",
    "table with units in the names of its columns",
    "FRD",
    lambda head: "gyro_x" in head or "accel_x" in head,
    read,
)
