"""Files of observations: one file and one line in ``READERS`` per format."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof.errors import ObservationError

from . import result_file, rinex
from .model import Observed, ObservedReader

if TYPE_CHECKING:
    from sdr_spoof.observations import Observations

__all__ = ["READERS", "Observations", "Observed", "ObservedReader", "open_observations"]

READERS: tuple[ObservedReader, ...] = (result_file.READER, rinex.READER)
"""Known formats; the first that takes a path reads it, and the last takes every path."""


def open_observations(path: Path | str) -> Observed:
    """Read a file of observations: a result file (``.h5``), or RINEX 3 or 4.

    Raises:
        ObservationError: it is missing, of another kind, or damaged; the message names the line.
        RecordingError: a result file that cannot be read.
    """
    path = Path(path)
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "does not exist"
        raise ObservationError(f"{path}: {what}; name a RINEX observation file or a result.h5")
    return next(r for r in READERS if r.matches(path)).read(path)
