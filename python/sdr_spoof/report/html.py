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
from sdr_spoof.fusion import per_test
from sdr_spoof.records import Acquisition, Alarm, SatelliteVerdict, TrackLog, Verdict
from sdr_spoof.report import words
from sdr_spoof.report.figures.difference import Margin, TruthMark, draw_difference, draw_margins
from sdr_spoof.report.figures.satellite import draw_satellite
from sdr_spoof.report.figures.signals import draw_acquisition, draw_cn0
from sdr_spoof.report.figures.spectrum import draw_spectrum
from sdr_spoof.report.spectrum import RecordingLike, estimate_spectrum
from sdr_spoof.sinks.atomic import replacing
from sdr_spoof.verdict import CLEAN, NO_SUPPORT, SPOOFED, SUSPECT, statistics, system_of

MARKS = {SPOOFED: "✖", SUSPECT: "?", CLEAN: "✔", NO_SUPPORT: "–"}
MOST_DETAILS = 16
"""Satellites drawn in detail, worst news first; more would make the report slow and large."""
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
    force: bool = False,
) -> Path:
    """Writes the report; the same input gives the same bytes.

    ``recording`` is read for the spectrum and may be None; ``effective_config`` is the (nested)
    configuration of the whole run. Raises OutputError if the file exists (unless ``force``) or
    cannot be written.
    """
    path = Path(path)
    if path.exists() and not force:
        raise OutputError(f"{path}: exists already; add --force to replace it")
    ordered = words.ordered(verdict)
    leading = words.leading_alarms(verdict)
    tests = _draw_tests(log, ordered, detection, truth)
    hit = [(s.system, s.prn) for s in ordered if s.verdict == SPOOFED]
    signals = list(
        dict.fromkeys([t.signal for t in log.signals] or [a.signal for a in acquisitions])
    )
    spectrum = estimate_spectrum(recording) if recording is not None else None
    content = _template().stream(
        words=words,
        verdict=verdict,
        level=words.level(verdict),
        alarms=leading,
        actions=[words.action_sentence(s) for s in ordered if s.verdict == SPOOFED],
        tested=words.tested_sentence(verdict, detection.detectors),
        satellites=ordered,
        marks=MARKS,
        log=log,
        recording=recording,
        acquisitions=sorted(acquisitions, key=lambda a: (words.name_of(a.signal, a.prn), a.signal)),
        acquisition_figure=draw_acquisition(acquisitions) if acquisitions else None,
        spectrum=spectrum,
        spectrum_figure=draw_spectrum(spectrum, signals) if spectrum is not None else None,
        cn0_figure=draw_cn0(log, hit) if log.signals else None,
        margins_figure=draw_margins([*tests.margins.values()], hit) if tests.margins else None,
        key_figures=[(a, tests.alarms[a]) for a in leading],
        details=list(_details(ordered[:MOST_DETAILS], log, tests, leading)),
        left_out=[words.satellite_name(s.system, s.prn) for s in ordered[MOST_DETAILS:]],
        config=list(flatten(effective_config or {"detection": detection.model_dump()})),
        versions=[(name, version(name)) for name in LIBRARIES]
        + [("Python", platform.python_version())],
    )
    with replacing(path, force=force) as temporary:
        content.dump(str(temporary), encoding="utf-8")  # never in one string: it has megabytes
    return path


def _template() -> Template:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2")


@dataclass
class _Tests:
    """Pictures of what was tested."""

    margins: dict[tuple[str, int], Margin] = field(default_factory=dict)
    alarms: dict[Alarm, str] = field(default_factory=dict)
    quiet: dict[tuple[str, int], str] = field(default_factory=dict)
    """Of satellites without an alarm: the section that came closest to the threshold."""


def _draw_tests(
    log: TrackLog,
    satellites: Sequence[SatelliteVerdict],
    config: DetectionConfig,
    truth: TruthMark | None,
) -> _Tests:
    verdicts = {(s.system, s.prn): s for s in satellites}
    detailed = {(s.system, s.prn) for s in satellites[:MOST_DETAILS]}
    drawn = _Tests()
    shown = per_test(config)
    for series in statistics(log, config):
        if series.time_s.size:
            key = series.system, series.prn
            mark = truth if _concerns(truth, *key) else None
            for alarm in verdicts[key].alarms:
                if series.raised(alarm) and series.covers(alarm.alarm_s):
                    drawn.alarms[alarm] = draw_difference(series, shown, alarm, mark)
            margin = Margin.of(series, shown)
            if key not in drawn.margins or margin.of_threshold > drawn.margins[key].of_threshold:
                drawn.margins[key] = margin
                if not verdicts[key].alarms and key in detailed:
                    drawn.quiet[key] = draw_difference(series, shown, None, mark)
        del series  # before the next one is made: they are large
    return drawn


def _concerns(truth: TruthMark | None, system: str, prn: int) -> bool:
    return truth is not None and truth.prn in (None, prn) and truth.system == system


def _details(
    satellites: Sequence[SatelliteVerdict],
    log: TrackLog,
    tests: _Tests,
    leading: Sequence[Alarm],
) -> Iterator[tuple[SatelliteVerdict, str, str | None, list[tuple[Alarm, str]]]]:
    """(satellite, small multiples, its closest test if all were quiet, alarms not shown above)."""
    for satellite in satellites:
        key = satellite.system, satellite.prn
        tracks = [t for t in log.signals if (system_of(t.signal), t.prn) == key]
        figure = draw_satellite(tracks, satellite.onset_s, log.duration_s)
        more = [(a, tests.alarms[a]) for a in satellite.alarms if a not in leading]
        yield satellite, figure, tests.quiet.get(key), more


def flatten(config: Mapping[str, object], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Nested configuration as (dotted key, value) rows."""
    for key, value in config.items():
        if isinstance(value, Mapping):
            yield from flatten(value, f"{prefix}{key}.")
        elif isinstance(value, list | tuple):
            yield f"{prefix}{key}", ", ".join(map(str, value))
        else:
            yield f"{prefix}{key}", str(value)
