"""The gain of a recorder's automatic gain control, as its log tells it.

Behind such a control the power of the samples stays the same, whatever reaches the antenna: what
rises shows in the gain. Powers divided by it are those of the antenna again.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

from .errors import RecordingError

MEMORY_S = 2.0
"""The tracker averages noise over such a memory (``track/quality.rs``)."""
_STEP_S = 0.01
COLUMNS = ("time_s", "gain_db")


@dataclass(frozen=True, eq=False)
class GainLog:
    """Gain against a constant one, a straight line in dB between N rows, constant beyond them."""

    time_s: NDArray[np.float64]
    """Since the first sample, ascending, (N,)."""
    gain_db: NDArray[np.float64]

    def power(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Power of the samples over that at the antenna, at times; the same shape."""
        found = np.interp(time_s, self.time_s, self.gain_db)
        return np.asarray(10.0 ** (0.1 * found), np.float64)

    def remembered_power(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same as a mean with the memory of the tracker's noise power."""
        grid_s, mean = self._remembered
        return np.asarray(np.interp(time_s, grid_s, mean), np.float64)

    @cached_property
    def _remembered(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        first, last = float(self.time_s[0]), float(self.time_s[-1])
        grid_s = np.arange(first, last + 10.0 * MEMORY_S, _STEP_S)
        keep = float(np.exp(-_STEP_S / MEMORY_S))
        power = self.power(grid_s)
        mean, _ = scipy.signal.lfilter([1 - keep], [1, -keep], power, zi=[keep * power[0]])
        return grid_s, mean


def read_gain(path: Path) -> GainLog:
    """Read a CSV file with the columns ``time_s`` and ``gain_db``; lines that begin with # are
    comments.

    Raises:
        RecordingError: it cannot be read, or a line is none; the message names it.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is no text"
        raise RecordingError(
            f"{path}: the recording's gain log cannot be read: {why}; restore it, or take "
            "gain_file out of the metadata"
        ) from error
    told = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and line[0] != "#"]
    if not told or tuple(told[0][1].replace(" ", "").split(",")) != COLUMNS:
        raise RecordingError(f"{path}: a gain log begins with the columns {','.join(COLUMNS)}")
    rows = [_row(path, number, line) for number, line in told[1:]]
    if not rows:
        raise RecordingError(f"{path}: the gain log has no rows; record it again, or leave it out")
    time_s, gain_db = np.array(rows, np.float64).T.copy()
    behind = np.flatnonzero(np.diff(time_s) <= 0)
    if behind.size:
        number = told[int(behind[0]) + 2][0]
        raise RecordingError(f"{path}: line {number}: times must ascend; sort the gain log")
    return GainLog(time_s, gain_db)


def _row(path: Path, number: int, line: str) -> tuple[float, float]:
    try:
        time_s, gain_db = (float(part) for part in line.split(","))
    except ValueError as error:
        raise RecordingError(f"{path}: line {number}: '{line}' is not a time and a gain") from error
    if not np.isfinite(time_s) or not abs(gain_db) < 200.0:
        raise RecordingError(f"{path}: line {number}: '{line}' is not a time in s and a gain in dB")
    return time_s, gain_db


def gain_text(log: GainLog) -> str:
    """Such a file."""
    rows = zip(log.time_s.tolist(), log.gain_db.tolist(), strict=True)
    return "".join([",".join(COLUMNS), "\n", *(f"{t:.6f},{g:.3f}\n" for t, g in rows)])
