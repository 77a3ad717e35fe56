"""Pictures of a receiver's report, asked for as soon as what they show is known."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.satellites import satellites_in, tracks_of

from .crew import finish
from .figures.evidence_panels import evidence_panels
from .figures.position import RouteDrawing, draw_geometry, draw_track
from .figures.quiet import QuietDrawing
from .figures.satellite import SatelliteDrawing
from .figures.signals import AcquisitionDrawing, Cn0Drawing
from .figures.sky_plot import draw_sky
from .figures.spectrum import SpectrumDrawing

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

    from sdr_spoof.records import Acquisition, SatelliteVerdict, TrackLog, Verdict
    from sdr_spoof.route import Route

    from .crew import Crew, Drawing, Picture
    from .evidence import EvidenceBook
    from .spectrum import Spectrum

MOST_DETAILS = 16
"""Satellites drawn in detail, worst news first; more would make the report slow and large."""


class Pictures:
    """Each is asked for once, whoever asks first."""

    def __init__(self, crew: Crew) -> None:
        """``crew`` draws them."""
        self._crew = crew
        self._asked: dict[Hashable, Picture | None] = {}
        self._dropped: dict[Hashable, Drawing] = {}

    def acquired(self, acquisitions: Sequence[Acquisition]) -> Picture | None:
        """C/N0 and Doppler of what was searched; None where nothing was."""
        if not acquisitions:
            return None
        return self._once("acquisition", lambda: AcquisitionDrawing.of(acquisitions))

    def spectrum(self, spectrum: Spectrum, signals: Sequence[str]) -> Picture | None:
        """Spectrum of the recording."""
        content = spectrum.rf_hz, spectrum.density_db, tuple(signals)
        return self._once("spectrum", lambda: SpectrumDrawing(*content))

    def tracked(self, log: TrackLog) -> None:
        """Satellites in detail, as they are drawn where no test will alarm."""
        if self._crew.alone:
            return
        for system, prn in satellites_in(log)[:MOST_DETAILS]:
            self._detail(log, system, prn, None)

    def judged(
        self, log: TrackLog, verdict: Verdict, book: EvidenceBook, order: Sequence[SatelliteVerdict]
    ) -> None:
        """All that the verdict bears on, of satellites in this order."""
        # What has not been begun is not needed any more, or will be asked for again.
        kept = {key: picture for key, picture in self._asked.items() if picture is not None}
        self._dropped = {key: p.drawing for key, p in kept.items() if p.drop()}
        self._asked = {key: p for key, p in kept.items() if key not in self._dropped}
        for satellite in order[:MOST_DETAILS]:
            self.detail(log, satellite)
            self.quiet(log, satellite, book)
        self.cn0(log, verdict)

    def detail(self, log: TrackLog, satellite: SatelliteVerdict) -> Picture | None:
        """Small multiples over all signals of a satellite."""
        return self._detail(log, satellite.system, satellite.prn, satellite.onset_s)

    def _detail(
        self, log: TrackLog, system: str, prn: int, onset_s: float | None
    ) -> Picture | None:
        return self._once(
            ("detail", system, prn, onset_s),
            lambda: SatelliteDrawing.of(tracks_of(log, system, prn), onset_s, log.duration_s),
        )

    def quiet(
        self, log: TrackLog, satellite: SatelliteVerdict, book: EvidenceBook
    ) -> Picture | None:
        """Tests of a satellite without an alarm; None where it has one, or nothing was tested."""
        key = satellite.system, satellite.prn
        if satellite.alarms or key not in book.satellites:
            return None

        def drawing() -> QuietDrawing | None:
            panels = evidence_panels(book.satellites[key], log.duration_s)
            signals = [track.signal for track in tracks_of(log, *key)]
            return QuietDrawing.of(panels, signals, log.duration_s)

        return self._once(("quiet", *key), drawing)

    def cn0(self, log: TrackLog, verdict: Verdict) -> Picture | None:
        """C/N0 of everything tracked; None where nothing was."""
        if not log.signals:
            return None
        verdicts = {(s.system, s.prn): s.verdict for s in verdict.satellites}
        return self._once("cn0", lambda: Cn0Drawing.of(log, verdicts))

    def located(self, route: Route) -> list[Picture]:
        """Sky, track, and geometry over time; the route has a position."""
        asked = [self._of(route, draw) for draw in (draw_sky, draw_track, draw_geometry)]
        return [picture for picture in asked if picture is not None]

    def _of(self, route: Route, draw: Callable[[Route], bytes]) -> Picture | None:
        return self._once(draw, lambda: RouteDrawing(draw, route))

    def finish(self) -> None:
        """Draw here what no process has begun."""
        finish([picture for picture in self._asked.values() if picture is not None])

    def _once(self, key: Hashable, make: Callable[[], Drawing | None]) -> Picture | None:
        if key not in self._asked:
            drawing = self._dropped.pop(key, None) or make()
            self._asked[key] = self._crew.ask(drawing) if drawing is not None else None
        return self._asked[key]
