"""Watching while tracking: a captured sideband is taken off its pair as soon as it is known.

At each whole second of the signal the detectors run on the last ``monitor_lookback_s`` of rows. A
satellite that they call spoofed, with a band named and another one left, has that band isolated:
the clean sideband goes on by itself, as the one to use, and the captured one is marked. Where the
band cannot be told, nothing is isolated; the verdict says that the satellite is to be dropped.

Only tests of consistency decide; the others are asked for the band once one of them has alarmed.
Those of code, which average over many seconds, look each ``CODE_EVERY_S`` s, and as many times
further back. What is looked at ends a little before the second, so that it depends on the signal
alone, not on how the input is cut or how many threads there are.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from .detectors import phase_difference_glr
from .fusion import SPOOFED, SUSPECT, evidence_of, share_of
from .isolation import Isolation
from .records import ComboTrack, SignalTrack, TrackLog
from .satellites import satellite_of
from .signals import system_of
from .verdict import detect

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .detectors import DetectionConfig
    from .row_store import RowStore

CODE_EVERY_S = 4
MARGIN_S = 0.05
"""Rows of the last instant may still be on their way."""


class Monitor:
    """Decides, second by second, which signals are to be isolated; each is isolated once."""

    def __init__(self, detection: DetectionConfig) -> None:
        """Watch with these detectors and thresholds."""
        self.isolated: list[Isolation] = []
        self._config = detection
        self._reflected: set[tuple[str, int]] = set()
        """Satellites whose jumps of phase a reflection explained: more of them say nothing."""
        strong = [n for n in detection.detectors if evidence_of(n) == "consistency"]
        self._often = self._of([n for n in strong if not n.startswith("code")])
        self._seldom = self._of(strong)

    def _of(self, names: Sequence[str]) -> DetectionConfig:
        """Some of the detectors, with the thresholds that all of them together have."""
        share = share_of(self._config, len(names))
        return share.model_copy(update={"detectors": tuple(names)})

    def look(self, rows: RowStore, sample_rate_hz: float, now_s: float) -> list[Isolation]:
        """What to isolate now, at a whole second, after all signal up to it has been tracked."""
        seldom = round(now_s) % CODE_EVERY_S == 0
        first = self._seldom if seldom else self._often
        if not first.detectors:
            return []
        lookback_s = self._config.monitor_lookback_s * (CODE_EVERY_S if seldom else 1)
        span = now_s - lookback_s, now_s - MARGIN_S
        combos = rows.between(ComboTrack, *span)
        if not combos:
            return []
        log = TrackLog(
            recording="",
            sample_rate_hz=sample_rate_hz,
            duration_s=now_s,
            partial=True,
            signals=rows.between(SignalTrack, *span),
            combos=combos,
        )
        new = self.captured(log, now_s, first)
        self.isolated += new
        return new

    def captured(self, log: TrackLog, now_s: float, first: DetectionConfig) -> list[Isolation]:
        """Signals that the log shows to be captured, of satellites with another one left.

        ``first`` says which detectors are asked first, before all of them are.
        """
        done = {(system_of(i.signal), i.prn) for i in self.isolated}
        open_ = dataclasses.replace(
            log,
            signals=tuple(t for t in log.signals if satellite_of(t) not in done),
            combos=tuple(c for c in log.combos if satellite_of(c) not in done),
        )
        if not open_.combos or not detect(open_, first).spoofed:
            return []
        # The other satellites are needed for the clock, the isolated ones too.
        found = []
        for s in detect(log, self._config).satellites:
            key = s.system, s.prn
            strong = {a.detector for a in s.alarms if evidence_of(a.detector) == "consistency"}
            if s.verdict == SUSPECT and strong:
                self._reflected.add(key)
            known = key in self._reflected and strong == {phase_difference_glr.NAME}
            if s.verdict != SPOOFED or s.band is None or s.fallback is None or known:
                continue
            if key not in done:
                found.append(Isolation(signal=s.band, prn=s.prn, from_s=now_s))
        return found
