"""From a recording to tracks: what ``track`` and ``process`` have in common."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from .acquisition import acquire
from .monitor import Monitor
from .second_peaks import second_peaks
from .tracking import track

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from .config import Config
    from .progress import Stages
    from .records import Acquisition, TrackLog
    from .sources import Recording


def receive(
    recording: Recording,
    config: Config,
    signals: Sequence[str] | None,
    prns: Sequence[int] | None,
    threads: int | None,
    stages: Stages,
    rows_in: Path,
    acquired: Callable[[Sequence[Acquisition]], object] = len,
) -> tuple[list[Acquisition], TrackLog]:
    """Acquire, and track what was detected; what comes before detection.

    The log's rows are in a temporary file in the folder ``rows_in``, not in memory. ``acquired`` is
    told what was found before it is tracked.
    """
    with stages("Acquiring") as progress:
        found = acquire(
            recording,
            config.acquisition,
            signals=signals,
            prns=prns,
            threads=threads,
            progress=progress,
        )
    acquired(found)
    detected = [a for a in found if a.detected]
    with stages("Tracking") as progress:
        log = track(
            recording,
            detected,
            config.tracking,
            monitor=Monitor(config.detection),
            threads=threads,
            rows_in=rows_in,
            progress=progress,
        )
    if config.acquisition.second_peak_every_s and not log.partial:
        with stages("Searching again") as progress:
            peaks = second_peaks(
                recording,
                log,
                config.acquisition,
                threads=threads or os.cpu_count() or 1,
                progress=progress,
            )
        log = replace(log, second_peaks=peaks)
    return found, log
