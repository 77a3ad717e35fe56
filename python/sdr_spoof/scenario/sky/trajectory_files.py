"""Trajectories in files."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import ConfigError
from sdr_spoof.nav.geodesy import geodetic_to_ecef

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

DAY_S = 86_400.0
_GLOBE = ("latitude_deg", "longitude_deg", "height_m")
_EARTH_FIXED = ("x_m", "y_m", "z_m")
_ATTITUDE = ("yaw_deg", "pitch_deg", "roll_deg")
_GGA_FIELDS = 12


@dataclass(frozen=True)
class Track:
    """Rows of a file."""

    time_s: NDArray[np.float64]
    """Increasing, (N,)."""
    position_m: NDArray[np.float64]
    """Earth-fixed, (N, 3)."""
    attitude_rad: NDArray[np.float64] | None = None
    """Yaw, pitch, roll, (N, 3)."""


def read_csv(path: Path) -> Track:
    """A table with a line of column names.

    ``time_s``; ``latitude_deg, longitude_deg, height_m`` or ``x_m, y_m, z_m`` (Earth-fixed); and,
    if known, ``yaw_deg, pitch_deg, roll_deg``. Other columns are left alone.

    Raises:
        ConfigError: it cannot be read, a column is missing, or a row is wrong.
    """
    header, *rows = _rows(path)
    columns = {name.strip(): k for k, name in enumerate(header)}
    place = next((p for p in (_GLOBE, _EARTH_FIXED) if all(n in columns for n in p)), None)
    if "time_s" not in columns or place is None:
        raise ConfigError(
            f"{path}: needs the columns time_s and {', '.join(_GLOBE)} (or "
            f"{', '.join(_EARTH_FIXED)}); it has {', '.join(columns) or 'none'}"
        )
    turned = all(n in columns for n in _ATTITUDE)
    names = ("time_s", *place, *(_ATTITUDE if turned else ()))
    table = np.array([_numbers(path, k, row, columns, names) for k, row in enumerate(rows, 2)])
    table = _checked(path, table)
    values = table[:, 1:4]
    position = values if place is _EARTH_FIXED else geodetic_to_ecef(values)
    return Track(table[:, 0], position, np.radians(table[:, 4:7]) if turned else None)


def read_nmea(path: Path) -> Track:
    """Positions of the GGA sentences of an NMEA 0183 log; its first one is at 0 s.

    Sentences without a fix or with a wrong checksum are left out. Heights are those above the
    ellipsoid: altitude plus geoid separation.

    Raises:
        ConfigError: it cannot be read, or has too few positions.
    """
    places = np.array(list(_gga(path))).reshape(-1, 4)
    if places.size:
        time = places[:, 0] + DAY_S * np.cumsum(np.diff(places[:, 0], prepend=places[0, 0]) < 0)
        places[:, 0] = time - time[0]
    places = _checked(path, places)
    return Track(places[:, 0], geodetic_to_ecef(places[:, 1:]))


def _rows(path: Path) -> list[list[str]]:
    rows = [r for r in csv.reader(_text(path).splitlines()) if r and not r[0].startswith("#")]
    if not rows:
        raise ConfigError(f"{path}: is empty; it needs a line of column names and rows")
    return rows


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not text: {error}") from error


def _numbers(
    path: Path, line: int, row: list[str], columns: dict[str, int], names: tuple[str, ...]
) -> list[float]:
    try:
        values = [float(row[columns[n]]) for n in names]
    except (ValueError, IndexError) as error:
        raise ConfigError(f"{path}: row {line} does not hold a number for each column") from error
    if not all(map(math.isfinite, values)):
        raise ConfigError(f"{path}: row {line} holds a number that is not finite")
    return values


def _checked(path: Path, table: NDArray[np.float64]) -> NDArray[np.float64]:
    if len(table) < 4:
        raise ConfigError(f"{path}: has {len(table)} positions; a trajectory needs 4 or more")
    if np.any(np.diff(table[:, 0]) <= 0):
        raise ConfigError(f"{path}: times must increase from row to row")
    return table


def _gga(path: Path) -> Iterator[tuple[float, float, float, float]]:
    """Time of day in s, latitude and longitude in degrees, height in m."""
    for line in _text(path).splitlines():
        sentence, _, checksum = line.strip().removeprefix("$").partition("*")
        fields = sentence.split(",")
        if not fields[0].endswith("GGA") or len(fields) < _GGA_FIELDS or fields[6] in ("", "0"):
            continue
        if checksum and checksum.upper() != f"{_exclusive_or(sentence):02X}":
            continue
        try:
            clock = fields[1]
            time = 3600 * int(clock[:2]) + 60 * int(clock[2:4]) + float(clock[4:])
            latitude = _degrees(fields[2]) * (-1 if fields[3] == "S" else 1)
            longitude = _degrees(fields[4]) * (-1 if fields[5] == "W" else 1)
            height = float(fields[9]) + float(fields[11] or 0.0)
        except ValueError:
            continue
        yield time, latitude, longitude, height


def _degrees(text: str) -> float:
    """``ddmm.mmmm`` or ``dddmm.mmmm``."""
    whole = text.index(".") - 2 if "." in text else len(text) - 2
    return int(text[:whole]) + float(text[whole:]) / 60


def _exclusive_or(sentence: str) -> int:
    total = 0
    for byte in sentence.encode("ascii", "replace"):
        total ^= byte
    return total
