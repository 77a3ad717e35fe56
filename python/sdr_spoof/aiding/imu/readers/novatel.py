"""Raw IMU logs of NovAtel SPAN receivers, in ASCII: RAWIMUA, RAWIMUSA, RAWIMUXA, RAWIMUSXA.

Chosen of the formats in use because its maker documents it in full (OEM7 Commands and Logs
Reference Manual, "RAWIMU" and "Raw IMU Scale Factors"), it holds GNSS time and increments as the
IMU gave them, and many public data sets of GNSS with an IMU have it. Values are counts: z, minus y,
x of velocity, then of angle; the extended logs name the IMU, whose scale factors are those of the
manual; for the others ``model`` does.
"""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import InertialError
from sdr_spoof.nav.time import WEEK_S, GnssTime

from ..rows import ACCEL_UNITS, GYRO_UNITS, STANDARD_G_M_S2, ImuRows, Unit
from .reader import Reader, text_of

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from ..config import ImuConfig

_LOGS = {"RAWIMUA": False, "RAWIMUSA": False, "RAWIMUXA": True, "RAWIMUSXA": True}
"""Names, and whether a log is extended."""
_FOOT_M = 0.3048
_ARC_S = math.radians(1.0) / 3600
_INCREMENTS = (
    next(u for u in GYRO_UNITS if u.name == "rad"),
    next(u for u in ACCEL_UNITS if u.name == "m_s"),
)
_MILLI_G = 1e-3 * STANDARD_G_M_S2


@dataclass(frozen=True)
class Scale:
    """Size of a count: "Raw IMU Scale Factors" of the manual."""

    models: tuple[str, ...]
    types: tuple[int, ...]
    """Numbers of the IMU in extended logs."""
    gyro: float
    """rad, or rad/s where ``rate``."""
    accel: float
    """m/s, or m/s^2."""
    rate: bool = False
    """Counts are rates, to be multiplied by the interval."""


SCALES = (
    Scale(("LN200",), (8,), 2.0**-19, 2.0**-14),
    Scale(
        ("HG1700-AG11", "HG1700-AG58", "HG1900", "HG1930"),
        (1, 11, 5, 27, 20, 28),
        2.0**-33,
        2.0**-27 * _FOOT_M,
    ),
    Scale(("HG1700-AG17", "HG1700-AG62"), (4, 12), 2.0**-33, 2.0**-26 * _FOOT_M),
    Scale(("HG4930",), (58, 68, 69), 2.0**-33, 2.0**-29),
    Scale(("FSAS",), (13,), 0.1 * 2.0**-8 * _ARC_S, 0.05 * 2.0**-15),
    Scale(("ISA-100C", "uIMU"), (26, 52), 1e-9, 2e-8),
    Scale(("ADIS16488",), (31,), 720 * 2.0**-31 * math.radians(1.0), 200 * 2.0**-31),
    Scale(("STIM300",), (32, 56), 2.0**-21 * math.radians(1.0), 2.0**-22),
    Scale(("KVH1750",), (33,), 0.1 / (3600 * 256), 0.05 * 2.0**-15),
    Scale(
        ("EG320N",),
        (41, 62),
        0.008 * 2.0**-16 * math.radians(1.0),
        0.2 * 2.0**-16 * _MILLI_G,
        rate=True,
    ),
    Scale(
        ("EG370N",),
        (61,),
        0.0151515 * 2.0**-16 * math.radians(1.0),
        0.4 * 2.0**-16 * _MILLI_G,
        rate=True,
    ),
)
_FIELDS = 9
"""Of a plain log: week, seconds, status, six counts."""


def read(path: Path, config: ImuConfig) -> ImuRows:
    """A log; other messages in it, and lines whose checksum is wrong, are left out.

    Raises:
        InertialError: no usable line, or the IMU is not known.
    """
    table, kinds = _table(path)
    week = int(table[0, 0])
    first_s = float(np.floor(table[0, 1]))
    scale = _scale(path, kinds, config)
    gyro_unit, accel_unit = _units(scale)
    # z, minus y, x.
    counts = table[:, [4, 3, 2, 7, 6, 5]] * [1, -1, 1, 1, -1, 1]
    return ImuRows(
        origin=str(path),
        reference=GnssTime.of_week(week, first_s),
        time_s=(table[:, 0] - week) * WEEK_S + (table[:, 1] - first_s),
        gyro=counts[:, 3:] * scale.gyro,
        accel=counts[:, :3] * scale.accel,
        gyro_unit=gyro_unit,
        accel_unit=accel_unit,
    )


def _table(path: Path) -> tuple[NDArray[np.float64], set[int | None]]:
    """Rows of week, seconds and six counts, and the types of IMUs."""
    starts = tuple(f"{mark}{name}," for name in _LOGS for mark in "#%")
    lines = [_line(line) for line in text_of(path).splitlines() if line.startswith(starts)]
    good = [line for line in lines if line is not None]
    if not good:
        hint = f"the checksums of all {len(lines)} are wrong" if lines else "there is none"
        raise InertialError(f"{path}: has no usable line of {', '.join(_LOGS)}: {hint}")
    return np.array([values for _, values in good]), {kind for kind, _ in good}


def _line(line: str) -> tuple[int | None, list[float]] | None:
    """Type of the IMU, if it is told, and week, seconds and six counts."""
    body, star, checksum = line[1:].rstrip().partition("*")
    try:
        if star and int(checksum, 16) != crc32(body.encode("ascii", "replace")):
            return None
        header, _, data = body.partition(";")
        fields = data.split(",")
        kind = None
        if _LOGS[header.partition(",")[0]]:
            kind, fields = int(fields[1]), fields[2:]
        if len(fields) != _FIELDS:
            return None
        return kind, [float(v) for v in (*fields[:2], *fields[3:])]
    except (ValueError, IndexError):
        return None


def crc32(data: bytes) -> int:
    """Checksum of NovAtel's logs: the common polynomial, without inversions."""
    return zlib.crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


def _scale(path: Path, kinds: set[int | None], config: ImuConfig) -> Scale:
    known = ", ".join(m for s in SCALES for m in s.models)
    if config.model is not None:
        wanted = config.model.casefold()
        found = [s for s in SCALES if wanted in map(str.casefold, s.models)]
        if not found:
            raise InertialError(f"[imu] model: unknown IMU '{config.model}'; known: {known}")
        return found[0]
    if kinds == {None}:
        raise InertialError(
            f"{path}: RAWIMU logs without X do not say of which IMU they are; give model: {known}"
        )
    if len(kinds) > 1:
        raise InertialError(f"{path}: holds logs of several IMUs; split it, or give model")
    (kind,) = kinds
    of_kind = [s for s in SCALES if kind in s.types]
    if not of_kind:
        raise InertialError(
            f"{path}: scale factors of IMU type {kind} are not known; give model: {known}"
        )
    return of_kind[0]


def _units(scale: Scale) -> tuple[Unit, Unit]:
    if not scale.rate:
        return _INCREMENTS
    return (
        next(u for u in GYRO_UNITS if u.name == "rad_s"),
        next(u for u in ACCEL_UNITS if u.name == "m_s2"),
    )


READER = Reader(
    "novatel",
    "RAWIMU, RAWIMUS, RAWIMUX or RAWIMUSX logs of NovAtel receivers, ASCII",
    "RFU",
    lambda head: any(f"{start}{name}," in head for name in _LOGS for start in "#%"),
    read,
)
