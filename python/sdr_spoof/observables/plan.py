"""First look at all tracks: which spans there are, and when what they hold was sent."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from sdr_spoof.gaps import uncounted
from sdr_spoof.observations import ObservedSignal
from sdr_spoof.signals import signal_spec

from .runs import runs_of
from .transmit import Span, spans_of, told_by_others

if TYPE_CHECKING:
    from sdr_spoof.nav.records import Navigation
    from sdr_spoof.records import TrackLog

Plan = dict[ObservedSignal, list[Span]]


def plan(log: TrackLog, navigation: Navigation) -> Plan:
    """Spans of every signal whose transmit time is known, with outlines of their runs."""
    outlines = {
        ObservedSignal(signal_spec(t.signal).system, t.prn, t.signal): [
            run.outline() for run in runs_of(t, uncounted(log, t))
        ]
        for t in log.signals
    }
    own = {
        signal: spans_of(
            signal.prn,
            runs,
            [a for a in navigation.anchors if (a.signal, a.prn) == (signal.signal, signal.prn)],
        )
        for signal, runs in outlines.items()
    }
    by_satellite: dict[str, list[Span]] = defaultdict(list)
    for signal, spans in own.items():
        by_satellite[signal.satellite] += spans
    found = {}
    for signal in sorted(outlines):
        told = {s.index for s in own[signal]}
        others = told_by_others(signal.prn, outlines[signal], by_satellite[signal.satellite])
        found[signal] = sorted(
            own[signal] + [s for s in others if s.index not in told], key=lambda s: s.from_s
        )
    return found
