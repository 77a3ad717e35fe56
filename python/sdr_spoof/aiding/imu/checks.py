"""What may be wrong with the rows of an IMU, and what to do about it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import InertialError

from ..increments import BRIDGE_S

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .rows import ImuRows

WEEK_S = 604_800.0
_LEAST_ROWS = 8
_GAP = 1.5
"""Intervals between rows from which on some are missing."""
_STUCK = 3
"""Rows in a row at the very largest value of a sensor that are no coincidence."""
_LOUD = 4.0
"""Against the rms about the mean: smaller extremes are no end of a range."""
_SLOWEST_S = 0.2
SHORT_S = 0.1
"""Longest piece beyond a sensor's range that is left out and bridged."""


def usable(rows: ImuRows) -> tuple[ImuRows, list[str]]:
    """Rows that can be navigated with, and notes on what was done to them.

    Raises:
        InertialError: too few rows, numbers that are not finite, times that do not ascend or are
            no seconds, or a sensor that was at the end of its range for too long.
    """
    _enough(rows)
    _finite(rows)
    _ascending(rows)
    _in_seconds(rows)
    rows, notes = _within_range(rows)
    return rows, [*notes, *_gaps(rows)]


def _enough(rows: ImuRows) -> None:
    if rows.time_s.size < _LEAST_ROWS:
        raise InertialError(
            f"{rows.origin}: holds {rows.time_s.size} rows of an IMU, which is too few: give at "
            f"least {_LEAST_ROWS}"
        )


def _finite(rows: ImuRows) -> None:
    values = np.column_stack([rows.time_s, rows.gyro, rows.accel])
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if bad.size:
        column = ("time", *(f"gyro {a}" for a in "xyz"), *(f"accelerometer {a}" for a in "xyz"))[
            int(np.argmin(np.isfinite(values[bad[0]])))
        ]
        raise InertialError(
            f"{rows.origin}: {bad.size} of {len(values)} rows are not numbers, the first is row "
            f"{bad[0] + 1} ({column}); leave such rows out, they are then treated as a gap"
        )


def _ascending(rows: ImuRows) -> None:
    steps = np.diff(rows.time_s)
    if steps.min() > 0:
        return
    row = int(np.argmax(steps <= 0)) + 1
    back_s = -float(steps[row - 1])
    where = f"{rows.origin}: row {row + 1}, at {rows.time_s[row]:.6f} s,"
    if back_s == 0:
        raise InertialError(
            f"{where} has the time of the row before; remove rows that are there twice, or write "
            "times with more digits"
        )
    if abs(back_s - WEEK_S) < 0.01 * WEEK_S:
        raise InertialError(
            f"{where} is a week before the row above: the week has rolled over; give the number of "
            "the week in a column gps_week, or split the file there"
        )
    raise InertialError(
        f"{where} is {back_s:.6g} s before the row above; sort the rows, or split the file where "
        "its clock was set back"
    )


def _in_seconds(rows: ImuRows) -> None:
    if rows.interval_s <= _SLOWEST_S:
        return
    names = {1e-3: "milliseconds", 1e-6: "microseconds", 1e-9: "nanoseconds"}
    found = [n for size, n in names.items() if 1e-3 < rows.interval_s * size <= 0.1]
    hint = f"are the times {' or '.join(found)}?" if found else "give all rows of the IMU"
    raise InertialError(
        f"{rows.origin}: rows are {rows.interval_s:.3g} s apart, too far to navigate with; {hint}"
    )


def _within_range(rows: ImuRows) -> tuple[ImuRows, list[str]]:
    """Leaves out what lies at the end of a sensor's range."""
    notes = []
    keep = np.ones(rows.time_s.size, bool)
    for kind, values in (("gyro", rows.gyro), ("accelerometer", rows.accel)):
        for axis in range(3):
            stuck = _stuck(values[:, axis])
            if not stuck.any():
                continue
            keep &= ~stuck
            notes.append(_range_note(rows, kind, "xyz"[axis], stuck))
    if not notes:
        return rows, []
    return (
        replace(rows, time_s=rows.time_s[keep], gyro=rows.gyro[keep], accel=rows.accel[keep]),
        notes,
    )


def _stuck(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Rows of runs at the largest or at the smallest value."""
    spread = float(values.std())
    stuck = np.zeros(values.size, bool)
    for extreme in (values.max(), values.min()):
        if spread == 0 or abs(extreme - np.median(values)) < _LOUD * spread:
            continue
        for first, last in _runs(values == extreme):
            stuck[first:last] |= last - first >= _STUCK
    return stuck


def _runs(marks: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First rows of the marked runs, and the rows after their last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marks, [False]])))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _range_note(rows: ImuRows, kind: str, axis: str, stuck: NDArray[np.bool_]) -> str:
    runs = _runs(stuck)
    first, last = max(runs, key=lambda run: run[1] - run[0])
    length_s = (last - first) * rows.interval_s
    text = f"{kind} {axis} is at the end of its range"
    if length_s > SHORT_S:
        raise InertialError(
            f"{rows.origin}: {text} for {length_s:.2f} s at {rows.time_s[first]:.2f} s, so that "
            "the motion is not known there: navigate up to it, and align anew after it"
        )
    return (
        f"{text} in {int(stuck.sum())} rows, first at {rows.time_s[runs[0][0]]:.2f} s: left out, "
        "and bridged"
    )


def _gaps(rows: ImuRows) -> list[str]:
    steps = np.diff(rows.time_s)
    late = np.flatnonzero(steps > _GAP * rows.interval_s)
    if not late.size:
        return []
    longest = late[np.argmax(steps[late])]
    missing_s = float(steps[longest]) - rows.interval_s
    what = "a gap of" if late.size == 1 else f"{late.size} gaps; the longest is"
    return [
        f"{what} {missing_s:.3g} s at {rows.time_s[longest]:.2f} s: up to {BRIDGE_S:g} s is "
        "bridged, after longer ones a new alignment is needed"
    ]
