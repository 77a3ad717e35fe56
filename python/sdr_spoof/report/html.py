"""The report: one offline HTML file with everything inside it."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template

from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.errors import OutputError
from sdr_spoof.fusion import share_of
from sdr_spoof.positioning import Located
from sdr_spoof.records import Acquisition, Alarm, SatelliteVerdict, TrackLog, Verdict
from sdr_spoof.report import words
from sdr_spoof.report.crew import Crew, Picture
from sdr_spoof.report.evidence import EvidenceBook
from sdr_spoof.report.figures.case import Case
from sdr_spoof.report.figures.difference import draw_difference
from sdr_spoof.report.figures.overview import draw_overview
from sdr_spoof.report.figures.truth import TruthMark
from sdr_spoof.report.pictures import MOST_DETAILS, Pictures
from sdr_spoof.report.position import position_part
from sdr_spoof.report.spectrum import RecordingLike, estimate_spectrum
from sdr_spoof.sinks.atomic import replacing
from sdr_spoof.verdict import CLEAN, NO_SUPPORT, SPOOFED, SUSPECT, statistics

MARKS = {SPOOFED: "✖", SUSPECT: "?", CLEAN: "✔", NO_SUPPORT: "–"}
MOST_OVERVIEWS = 3
"""Overviews at the top of the report; those of further satellites are in their details."""
MOST_ALARMS = 2
"""Alarms of a satellite with a figure of their own; the overview shows them all."""
LIBRARIES = ("sdr-spoof", "numpy", "scipy", "matplotlib")


def write_report(
    path: Path,
    *,
    recording: RecordingLike | None,
    acquisitions: Sequence[Acquisition],
    log: TrackLog,
    verdict: Verdict,
    detection: DetectionConfig,
    effective_config: Mapping[str, object] | None = None,
    truth: TruthMark | None = None,
    located: Located | None = None,
    why_not_located: str = "",
    book: EvidenceBook | None = None,
    pictures: Pictures | None = None,
    force: bool = False,
) -> Path:
    """Writes the report; the same input gives the same bytes.

    ``recording`` is read for the spectrum and may be None; ``effective_config`` is the (nested)
    configuration of the whole run; ``why_not_located`` says why there are no positions; ``book``
    has what detection showed, without it all tests are made again; ``pictures`` are those that have
    been asked for already. Raises OutputError if the file exists (unless ``force``) or cannot be
    written.
    """
    path = Path(path)
    if path.exists() and not force:
        raise OutputError(f"{path}: exists already; add --force to replace it")
    ordered = words.ordered(verdict)
    book = book or _book_of(log, detection)
    book.judge(verdict)
    pictures = pictures or Pictures(Crew())
    acquired = pictures.acquired(acquisitions)
    verdicts = {(s.system, s.prn): s.verdict for s in ordered}
    signals = list(
        dict.fromkeys([t.signal for t in log.signals] or [a.signal for a in acquisitions])
    )
    spectrum = estimate_spectrum(recording) if recording is not None else None
    spectral = pictures.spectrum(spectrum, signals) if spectrum is not None else None
    cn0 = pictures.cn0(log, verdict)
    tests = _draw_tests(log, verdict, book, truth)
    position = position_part(located, why_not_located, pictures)
    pictures.finish()
    content = template("report.html.j2").stream(
        words=words,
        verdict=verdict,
        level=words.level(verdict),
        accused=[s for s in ordered if s.alarms],
        tested=words.tested_sentence(verdict, detection.detectors),
        tests=words.tests(detection.detectors),
        satellites=ordered,
        marks=MARKS,
        log=log,
        recording=recording,
        acquisitions=sorted(acquisitions, key=lambda a: (words.name_of(a.signal, a.prn), a.signal)),
        acquisition_figure=_uri(acquired),
        spectrum=spectrum,
        spectrum_figure=_uri(spectral),
        cn0_figure=_uri(cn0),
        table=list(book.rows(detection.detectors, list(verdicts))),
        verdicts=verdicts,
        overviews=[(s, tests.overviews[s.system, s.prn]) for s in ordered if _on_top(s, ordered)],
        details=list(_details(ordered[:MOST_DETAILS], log, tests, pictures, book)),
        position=position,
        left_out=[words.satellite_name(s.system, s.prn) for s in ordered[MOST_DETAILS:]],
        config=list(flatten(effective_config or {"detection": detection.model_dump()})),
        versions=[(name, version(name)) for name in LIBRARIES]
        + [("Python", platform.python_version())],
    )
    with replacing(path, force=force) as temporary:
        content.dump(str(temporary), encoding="utf-8")  # never in one string: it has megabytes
    return path


def template(name: str) -> Template:
    """Page of the folder ``templates``."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name)


def _on_top(satellite: SatelliteVerdict, ordered: Sequence[SatelliteVerdict]) -> bool:
    """Whether a satellite's overview is at the top of the report."""
    return bool(satellite.alarms) and satellite in ordered[:MOST_OVERVIEWS]


@dataclass
class _Tests:
    """Pictures of tests that alarmed."""

    overviews: dict[tuple[str, int], str] = field(default_factory=dict)
    alarms: dict[Alarm, str] = field(default_factory=dict)


def _book_of(log: TrackLog, config: DetectionConfig) -> EvidenceBook:
    book = EvidenceBook(config)
    for series in statistics(log, config):
        book.take(series)
        del series  # before the next one is made: they are large
    return book


def _draw_tests(
    log: TrackLog, verdict: Verdict, book: EvidenceBook, truth: TruthMark | None
) -> _Tests:
    satellites = words.ordered(verdict)[:MOST_DETAILS]
    shown = [alarm for s in satellites for alarm in s.alarms[:MOST_ALARMS]]
    drawn = _Tests(alarms=_draw_alarms(log, book.config, shown, truth))
    for satellite in satellites:
        key = satellite.system, satellite.prn
        if satellite.alarms and key in book.satellites:
            case = Case.of(satellite, book.satellites[key], log, _of(truth, *key))
            drawn.overviews[key] = draw_overview(case)
    return drawn


def _draw_alarms(
    log: TrackLog, config: DetectionConfig, alarms: Sequence[Alarm], truth: TruthMark | None
) -> dict[Alarm, str]:
    """Measurement and statistic around alarms; their detectors run once more."""
    names = [n for n in dict.fromkeys(config.detectors) if n in {a.detector for a in alarms}]
    if not names:
        return {}
    some = share_of(config, len(names)).model_copy(update={"detectors": tuple(names)})
    drawn = {}
    for series in statistics(log, some):
        for alarm in alarms:
            if series.raised(alarm) and series.covers(alarm.alarm_s):
                mark = _of(truth, alarm.system, alarm.prn)
                drawn[alarm] = draw_difference(series, share_of(config), alarm, mark)
        del series  # before the next one is made: they are large
    return drawn


def _of(truth: TruthMark | None, system: str, prn: int) -> TruthMark | None:
    return truth if truth is not None and truth.concerns(system, prn) else None


def _details(
    satellites: Sequence[SatelliteVerdict],
    log: TrackLog,
    tests: _Tests,
    pictures: Pictures,
    book: EvidenceBook,
) -> Iterator[tuple[SatelliteVerdict, str | None, str | None, str | None, list[tuple[Alarm, str]]]]:
    """(satellite, small multiples, overview not at the top, tests of a quiet one, alarms)."""
    for satellite in satellites:
        key = satellite.system, satellite.prn
        figure = _uri(pictures.detail(log, satellite))
        overview = None if _on_top(satellite, satellites) else tests.overviews.get(key)
        quiet = _uri(pictures.quiet(log, satellite, book))
        alarms = [(a, tests.alarms[a]) for a in satellite.alarms if a in tests.alarms]
        yield satellite, figure, overview, quiet, alarms


def _uri(picture: Picture | None) -> str | None:
    return picture.uri if picture is not None else None


def flatten(config: Mapping[str, object], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Nested configuration as (dotted key, value) rows."""
    for key, value in config.items():
        if isinstance(value, Mapping):
            yield from flatten(value, f"{prefix}{key}.")
        elif isinstance(value, list | tuple):
            yield f"{prefix}{key}", ", ".join(map(str, value))
        else:
            yield f"{prefix}{key}", str(value)
