"""Files of aided navigation: every number as HDF5, and the epochs as CSV."""

from __future__ import annotations

import csv
import io
import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix
from sdr_spoof.sinks.atomic import replacing, write_bytes
from sdr_spoof.sinks.hdf5_file import new_file
from sdr_spoof.sinks.hdf5_nested import write_nested
from sdr_spoof.sinks.hdf5_records import write_text

from .records import Guard, Use

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from .records import AidedTrack, SmoothedTrack
    from .run import Aided

FORMAT_VERSION = 1
COLUMNS = (
    "gpst", "week", "tow_s", "latitude_deg", "longitude_deg", "height_m", "east_m_s", "north_m_s",
    "up_m_s", "yaw_deg", "pitch_deg", "roll_deg", "sigma_east_m", "sigma_north_m", "sigma_up_m",
    "horizontal_level_m", "vertical_level_m", "gnss_alone_off_m", "filter", "used", "left_out",
)  # fmt: skip
SMOOTHED = (
    "smoothed_latitude_deg", "smoothed_longitude_deg", "smoothed_height_m", "smoothed_east_m_s",
    "smoothed_north_m_s", "smoothed_up_m_s", "smoothed_yaw_deg", "smoothed_pitch_deg",
    "smoothed_roll_deg", "smoothed_sigma_east_m", "smoothed_sigma_north_m", "smoothed_sigma_up_m",
)  # fmt: skip
"""Columns behind those, of a track that was smoothed."""
ONE_WRONG = ("horizontal_level_one_wrong_m", "vertical_level_one_wrong_m")
"""Columns behind all others, if those levels were asked for."""


def write_hdf5(path: Path, aided: Aided, config: Mapping[str, Any], *, force: bool = False) -> None:
    """Write all records, one group each, as :mod:`sdr_spoof.sinks.hdf5_nested` has it.

    Raises:
        OutputError: it exists and ``force`` is not set, or it cannot be written.
    """
    with replacing(path, force=force) as temporary, new_file(temporary) as file:
        file.attrs["aided_format_version"] = FORMAT_VERSION
        write_text(file, "config", json.dumps(config, sort_keys=True))
        for name in ("verdict", "track", "measurements", "inertial"):
            record = getattr(aided, name)
            if record is not None:
                write_nested(file.create_group(name, track_order=True), record)
        for name in ("monitors", "residuals"):
            group = file.create_group(name, track_order=True)
            for number, monitor in enumerate(getattr(aided, name)):
                write_nested(group.create_group(f"{number:02d}", track_order=True), monitor)


def write_csv(path: Path, track: AidedTrack, *, force: bool = False) -> None:
    """Write a row for each epoch; empty where there is no value.

    Raises:
        OutputError: as :func:`write_hdf5`.
    """
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow([*COLUMNS, *(name for names, _ in _more(track) for name in names)])
    for e, row in enumerate(_rows(track)):
        table.writerow([*row, *(value for _, values in _more(track) for value in values(e))])
    write_bytes(path, text.getvalue().encode(), force=force)


def _more(track: AidedTrack) -> Iterator[tuple[tuple[str, ...], Callable[[int], Iterator[str]]]]:
    """Columns that were asked for, and what stands in them at an epoch."""
    later, level, height = track.smoothed, track.horizontal_one_wrong_m, track.vertical_one_wrong_m
    if later is not None:
        yield SMOOTHED, lambda e: _state(later, e)
    if level is not None and height is not None:
        yield ONE_WRONG, lambda e: (_number(v[e], 3) for v in (level, height))


def _rows(track: AidedTrack) -> Iterator[list[str]]:
    off = np.linalg.norm(track.alone_m - track.position_m, axis=1)
    for e in range(len(track.time_s)):
        time = track.reference + float(track.time_s[e])
        week, tow_s = time.week_tow()
        date = time.calendar().replace(tzinfo=None).isoformat(timespec="microseconds")
        used = track.use[e] == Use.USED
        out = (track.use[e] == Use.EXCLUDED) | (track.use[e] == Use.NAMED)
        yield [
            *(date, str(week), f"{tow_s:.6f}"),
            *_state(track, e),
            *(_number(v, 3) for v in (track.horizontal_m[e], track.vertical_m[e], off[e])),
            Guard(track.guard[e]).name.lower(),
            *(" ".join(np.array(track.satellites)[which]) for which in (used, out)),
        ]


def _state(track: AidedTrack | SmoothedTrack, e: int) -> Iterator[str]:
    """Place, velocity, attitude and standard deviations of an epoch."""
    place = ecef_to_geodetic(track.position_m[e])
    known = bool(np.isfinite(place).all())
    axes = enu_matrix(*place[:2]) if known else np.full((3, 3), np.nan)
    yield from (_number(v, d) for v, d in zip(place, (9, 9, 3), strict=True))
    yield from (_number(v, 4) for v in axes @ track.velocity_m_s[e])
    yield from (_number(v, 4) for v in np.degrees(track.attitude_rad[e]))
    yield from (_number(v, 3) for v in track.sigma_enu_m[e])


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else ""
