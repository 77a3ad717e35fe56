"""``sdr-spoof fix``: positions, and the files that others read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sdr_spoof import config
from sdr_spoof.errors import ConfigError, RecordingError

from . import options
from .command import INTERRUPTED, Command, Outcome

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from rich.console import Console

    from sdr_spoof.config import Config
    from sdr_spoof.positioning import Located
    from sdr_spoof.records import TrackLog
    from sdr_spoof.sinks.hdf5 import Result

    from .ui import Ui

RESULT = ".h5"
NO_FIX = 3
"""Exit code where nothing went wrong but there is no position; files are written all the same."""


def _configure(parser: argparse.ArgumentParser) -> None:
    options.add_recording(parser, also="; or a result file of process or track (.h5)")
    options.add_selection(parser)
    options.add_output(parser, "folder for the files", required=True)
    parser.add_argument(
        "--format",
        nargs="+",
        metavar="NAME",
        dest="formats",
        help="files to write, such as rinex nmea geojson kml csv hdf5 (default: all)",
    )
    shorter = parser.add_argument_group("navigation, in short")
    for flag, name, metavar in (
        ("--nav", "navigation.files", "FILE.rnx,..."),
        ("--rate", "observables.rate_hz", "HZ"),
        ("--time", "navigation.time", "UTC"),
        ("--place", "navigation.place", "LAT,LON,H"),
    ):
        long = config.flag_name(name.split("."))
        help_text = f"the same as {long}"
        shorter.add_argument(flag, dest=config.FLAG_PREFIX + name, metavar=metavar, help=help_text)
    options.add_threads(parser)
    groups = ["acquisition", "tracking", "detection", "navigation", "observables", "pvt"]
    config.add_flags(parser, groups)


def _formats(arguments: argparse.Namespace) -> list[str]:
    """Formats asked for.

    Raises:
        ConfigError: one is not known.
    """
    from sdr_spoof.positioning.formats import FORMATS  # noqa: PLC0415

    asked = list(dict.fromkeys(arguments.formats or FORMATS))
    for name in asked:
        if name not in FORMATS:
            raise ConfigError(f"--format: there is no '{name}'; known: {', '.join(FORMATS)}")
    return asked


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.pipeline import output_folder, output_paths  # noqa: PLC0415
    from sdr_spoof.positioning import locate  # noqa: PLC0415
    from sdr_spoof.positioning.formats import FORMATS, write_formats  # noqa: PLC0415

    settings = config.from_arguments(arguments)
    chosen = _formats(arguments)
    names = [output.name for f in chosen for output in FORMATS[f]]
    output_paths(arguments.output, names, force=arguments.force)
    with output_folder(arguments.output):
        log, result = _received(arguments, settings, ui)
        with ui.stages("Positioning"):
            found = locate(
                log,
                settings,
                result.verdict,
                start=result.start,
                acquisitions=result.acquisitions,
            )
        result = replace(result, log=None, **found.records())
        paths = write_formats(arguments.output, found, result, chosen, force=arguments.force)
    return _outcome(found, log, paths, settings, ui)


def _received(arguments: argparse.Namespace, settings: Config, ui: Ui) -> tuple[TrackLog, Result]:
    """Tracks, and the rest of what is known: from a result file, or from the recording."""
    from sdr_spoof.receive import receive  # noqa: PLC0415
    from sdr_spoof.sinks.hdf5 import Result, read_result  # noqa: PLC0415
    from sdr_spoof.verdict import detect  # noqa: PLC0415

    if arguments.recording.suffix == RESULT:
        result = read_result(arguments.recording)
        if result.log is None:
            raise RecordingError(
                f"{arguments.recording}: holds no tracks; name the recording, or a result file "
                "of process or track"
            )
        log, result = result.log, replace(result, config=settings.model_dump(mode="json"))
    else:
        recording = options.recording_from(arguments)
        signals = options.signals_from(arguments, recording)
        prns, folder = options.prns_from(arguments), arguments.output
        threads, stages = arguments.threads, ui.stages
        found, log = receive(recording, settings, signals, prns, threads, stages, folder)
        result = Result.of(recording, settings, acquisitions=found, log=log)
    if result.verdict is None:
        with ui.stages("Detecting"):
            result = replace(result, verdict=detect(log, settings.detection))
    return log, result


def _outcome(found: Located, log: TrackLog, paths: list[Path], settings: Config, ui: Ui) -> Outcome:
    from sdr_spoof.positioning.summary import sentences, summarise  # noqa: PLC0415

    summary = summarise(found)
    data = {
        "recording": log.recording,
        "partial": log.partial,
        "duration_s": log.duration_s,
        "position": summary,
        "config": settings,
        "files": paths,
    }

    def render(console: Console) -> None:
        for text in (*sentences(summary), *summary.notes):
            console.print(text, highlight=False, soft_wrap=True, markup=False)
        for path in paths:
            console.print(f"  {path}", highlight=False, soft_wrap=True, markup=False)

    if log.partial:
        return Outcome(data, render, INTERRUPTED)
    if not summary.fixes and ui.json_mode:
        ui.note(next(sentences(summary)))
    return Outcome(data, render, 0 if summary.fixes else NO_FIX)


COMMAND = Command(
    "fix",
    "compute positions, and write RINEX, NMEA, GeoJSON, KML and CSV",
    _configure,
    _run,
    usage="REC|RESULT.h5 -o FOLDER [options]",
    details="Receives the recording, or takes the tracks of a result file, decodes the messages "
    "and computes a position for every epoch; satellites that the detectors call spoofed are left "
    "out, and the fixes say so. A navigation file, with a time and a place, gives a fix where the "
    "recording is too short for a message. The exit code is 3 where there is no position.",
    examples=(
        "sdr-spoof fix recording.sigmf-meta -o out/fix",
        "sdr-spoof fix out/today/result.h5 -o out/fix --rate 10 --format nmea rinex",
        "sdr-spoof fix second.sigmf-meta -o out/fix --nav brdc.rnx --time 2023-03-12T12:00:00 "
        "--place 31.2,121.5,30",
    ),
)
