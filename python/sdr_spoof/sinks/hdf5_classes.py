"""Which records of navigation a result file may hold."""

from __future__ import annotations

from sdr_spoof.fixes import Fixes
from sdr_spoof.nav.broadcast import Bdgim, Klobuchar, TimeOffset, UtcParameters
from sdr_spoof.nav.ephemeris import Ephemeris
from sdr_spoof.nav.integrity import GridPoint, Integrity
from sdr_spoof.nav.records import Anchor, Frame, Navigation
from sdr_spoof.observables.clock import ClockPiece, ReceiverClock
from sdr_spoof.observations import Observations, ObservedSignal

CLASSES: dict[str, type] = {
    c.__name__: c
    for c in (
        *(Anchor, Bdgim, Ephemeris, Frame, Klobuchar, Navigation, TimeOffset, UtcParameters),
        *(GridPoint, Integrity),
        *(ClockPiece, Fixes, ObservedSignal, Observations, ReceiverClock),
    )
}
"""By name."""
