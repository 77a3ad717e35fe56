"""What the overview draws of one satellite."""

from __future__ import annotations

from dataclasses import dataclass

from sdr_spoof.fusion import deciding
from sdr_spoof.records import SatelliteVerdict, SignalTrack, TrackLog
from sdr_spoof.report.evidence import Evidence
from sdr_spoof.report.figures import style
from sdr_spoof.report.figures.satellite import SAMPLED_EPOCHS
from sdr_spoof.report.figures.truth import TruthMark
from sdr_spoof.signals import signal_spec


@dataclass(frozen=True)
class Case:
    """What is drawn of one satellite."""

    satellite: SatelliteVerdict
    evidence: Evidence
    log: TrackLog
    tracks: tuple[SignalTrack, ...]
    """Thinned, in memory."""
    whole: tuple[SignalTrack, ...]
    """The same with every epoch, to be read in parts."""
    truth: TruthMark | None

    @classmethod
    def of(
        cls,
        satellite: SatelliteVerdict,
        evidence: Evidence,
        log: TrackLog,
        truth: TruthMark | None,
    ) -> Case:
        """From the log, of whose long tracks every n-th epoch is taken."""
        tracks = (t for t in log.signals if t.prn == satellite.prn)
        mine = tuple(t for t in tracks if signal_spec(t.signal).system == satellite.system)
        sampled = tuple(t.sampled(SAMPLED_EPOCHS) for t in mine)
        return cls(satellite, evidence, log, sampled, mine, truth)

    @property
    def onset_s(self) -> float:
        """Onset of the verdict; without an alarm the end."""
        onset_s = self.satellite.onset_s
        return onset_s if onset_s is not None else self.log.duration_s

    @property
    def alarm_s(self) -> float:
        """First of the alarms that the verdict rests on."""
        return min(a.alarm_s for a in deciding(self.satellite.alarms))

    @property
    def colour(self) -> str:
        """Colour of what was found."""
        return style.VERDICTS.get(self.satellite.verdict, style.ALARM)

    @property
    def suspicion_s(self) -> float | None:
        """First alarm, where it came before that."""
        early = [a.alarm_s for a in self.satellite.alarms if a.alarm_s < self.alarm_s]
        return min(early, default=None)
