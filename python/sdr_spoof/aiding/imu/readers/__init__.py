"""Files of IMUs: one file and one line in ``READERS`` per format."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof.errors import InertialError

from ..axes import into_body
from ..checks import usable
from ..config import ImuConfig
from ..plausible import plausible
from . import novatel, table
from .reader import Reader

if TYPE_CHECKING:
    from ...records import ImuLog

__all__ = ["READERS", "ImuReading", "Reader", "read_imu"]

READERS: tuple[Reader, ...] = (novatel.READER, table.READER)
"""Known formats; the first that matches what a file begins with reads it."""
_HEAD_BYTES = 65_536


@dataclass(frozen=True)
class ImuReading:
    """An IMU's file."""

    log: ImuLog
    """Increments in body axes."""
    format: str
    notes: tuple[str, ...]
    """What was left out, and what could not be told."""
    lever_arm_m: tuple[float, float, float] | None = None
    """Antenna from the IMU, where the file tells."""


def read_imu(path: Path | str, config: ImuConfig | None = None) -> ImuReading:
    """Read a file of an IMU, and judge it.

    Rates become increments. Rows that lie beyond a sensor's range for a moment are left out. Times
    are by the IMU's clock less ``clock_offset_s``.

    Args:
        path: The file.
        config: How it is mounted and to be read.

    Raises:
        InertialError: it cannot be read; numbers are missing, times do not ascend, a sensor was
            beyond its range; units or axes are not what they are said to be. The message names the
            likely mistake and what to do.
    """
    path, config = Path(path), config or ImuConfig()
    reader = _reader(path, config)
    rows, notes = usable(reader.read(path, config))
    turn = into_body(config.axes or reader.axes).T
    rows = replace(
        rows,
        time_s=rows.time_s - config.clock_offset_s,
        gyro=rows.gyro @ turn,
        accel=rows.accel @ turn,
    )
    if config.checks:
        notes += plausible(rows)
    return ImuReading(rows.increments(), reader.name, tuple(notes), rows.lever_arm_m)


def _reader(path: Path, config: ImuConfig) -> Reader:
    if config.format is not None:
        found = [r for r in READERS if r.name == config.format]
        if not found:
            known = ", ".join(r.name for r in READERS)
            raise InertialError(f"[imu] format: unknown '{config.format}'; known: {known}")
        return found[0]
    head = _head(path)
    for reader in READERS:
        if reader.matches(head):
            return reader
    raise InertialError(
        f"{path}: is no file of an IMU that is known: {'; '.join(r.title for r in READERS)}. A "
        "table needs columns such as time_s, gyro_x_rad_s, accel_x_m_s2"
    )


def _head(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return file.read(_HEAD_BYTES).decode("utf-8-sig", "replace")
    except OSError as error:
        raise InertialError(f"{path}: cannot be read: {error.strerror}") from error
