"""Observations in a result file of ``process`` or ``fix``."""

from __future__ import annotations

from pathlib import Path

from sdr_spoof.errors import ObservationError
from sdr_spoof.sinks.hdf5 import read_result

from .model import Observed, ObservedReader


def read(path: Path) -> Observed:
    """Read it.

    Raises:
        ObservationError: it holds no observations.
        RecordingError: it is no result file.
    """
    result = read_result(path)
    if result.observations is None:
        raise ObservationError(
            f"{path}: holds no observations, since no position was to be had or asked for; run "
            "'sdr-spoof fix' on it with a navigation file (--nav), and give its result"
        )
    return Observed(result.observations, result.navigation, result.verdict)


READER = ObservedReader("result file", lambda path: path.suffix == ".h5", read)
