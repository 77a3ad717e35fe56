"""Which tracks of a log are of which satellite: PRNs of two systems are the same numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .records import ComboTrack
from .signals import system_of

if TYPE_CHECKING:
    from .records import SignalTrack, TrackLog


def satellite_of(track: SignalTrack | ComboTrack) -> tuple[str, int]:
    """RINEX system letter and PRN of a track."""
    signal = track.upper if isinstance(track, ComboTrack) else track.signal
    return system_of(signal), track.prn


def satellites_in(log: TrackLog) -> list[tuple[str, int]]:
    """(RINEX system letter, PRN) of everything tracked, sorted."""
    return sorted({*map(satellite_of, log.signals), *map(satellite_of, log.combos)})


def tracks_of(log: TrackLog, system: str, prn: int) -> list[SignalTrack]:
    """The tracks of a satellite's signals."""
    return [t for t in log.signals if satellite_of(t) == (system, prn)]


def combos_of(log: TrackLog, system: str, prn: int) -> list[ComboTrack]:
    """The joint tracks of a satellite."""
    return [c for c in log.combos if satellite_of(c) == (system, prn)]
