"""``sdr-spoof array``: do signals come from the sky, by several antennas on a moving vehicle."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof import config
from sdr_spoof.errors import ConfigError

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable, Sequence

    from rich.console import Console

    from sdr_spoof.aiding.array.examine import Finding, Vehicle
    from sdr_spoof.aiding.array.geometry import AntennaArray
    from sdr_spoof.records import TrackLog
    from sdr_spoof.sources import Recording

    from .ui import Ui

FILES = ("report.html", "array.png", "array.csv")


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "recordings",
        nargs="+",
        type=Path,
        metavar="REC",
        help="recordings of the antennas that began with the same sample, the reference's first",
    )
    parser.add_argument(
        "--elements",
        metavar="F,R,D;...",
        help="places of the antennas in m: forward, right, down of each, such as "
        "0,0,0;0.4,0,0;0.2,0.35,0",
    )
    parser.add_argument(
        "--vehicle",
        type=Path,
        metavar="FILE.csv",
        help="what the INS says: time_s since the first sample; latitude_deg, longitude_deg, "
        "height_m or x_m, y_m, z_m; yaw_deg, pitch_deg, roll_deg",
    )
    parser.add_argument(
        "--nav", type=Path, metavar="FILE.rnx", help="RINEX navigation file (default: none)"
    )
    parser.add_argument(
        "--lines",
        metavar="M,...",
        help="calibrated lines: by how many m each antenna's is electrically longer than the "
        "reference's, such as 0.012,-0.004; with it directions of arrival are tested too, which "
        "needs --nav",
    )
    options.add_selection(parser)
    options.add_output(parser, "folder for the report, the picture and the table of tests")
    options.add_threads(parser)
    config.add_flags(parser, ["acquisition", "tracking", "array"])


@dataclass(frozen=True)
class _Given:
    """What the arguments name, fit to go together."""

    array: AntennaArray
    recordings: list[Recording]
    moving: Vehicle
    lines_m: list[float] | None
    known: bool
    """Whether orbits are."""


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.aiding.array.examine import examine  # noqa: PLC0415
    from sdr_spoof.pipeline import output_folder, output_paths  # noqa: PLC0415

    settings = config.from_arguments(arguments)
    if arguments.output is not None:
        output_paths(arguments.output, FILES, force=arguments.force)
    # What does not go together is said before the long work.
    given = _given(arguments)
    logs = _tracked(given.recordings, arguments, ui, settings)
    findings = examine(logs, given.array, given.moving, settings.array, given.lines_m)
    if arguments.output is not None:
        with ui.stages("Reporting"), output_folder(arguments.output):
            _write(arguments, settings, given, findings)
    return _outcome(findings, arguments, known=given.known)


def _given(arguments: argparse.Namespace) -> _Given:
    from sdr_spoof.aiding.array.examine import check_lines, check_number  # noqa: PLC0415
    from sdr_spoof.aiding.array.geometry import array_of  # noqa: PLC0415
    from sdr_spoof.aiding.array.vehicle import vehicle  # noqa: PLC0415
    from sdr_spoof.nav.rinex_nav import read_navigation  # noqa: PLC0415
    from sdr_spoof.nav.store import Store  # noqa: PLC0415
    from sdr_spoof.nav.time import GnssTime  # noqa: PLC0415
    from sdr_spoof.scenario.sky.trajectory_files import read_csv  # noqa: PLC0415
    from sdr_spoof.sources import open_recording  # noqa: PLC0415

    for name, value in (("--elements", arguments.elements), ("--vehicle", arguments.vehicle)):
        if value is None:
            raise ConfigError(f"{name}: missing; an array's directions need it, see --help")
    array = array_of(_elements(arguments.elements))
    track = read_csv(arguments.vehicle)
    lines_m = _lines(arguments.lines)
    store = Store(read_navigation(arguments.nav)) if arguments.nav else None
    recordings = [open_recording(path) for path in arguments.recordings]
    first = recordings[0].start
    start = None if first is None else GnssTime.of_utc(first)
    check_number(len(recordings), array)
    check_lines(lines_m, array)
    known = store is not None and start is not None
    if lines_m is not None and not known:
        raise ConfigError(
            "--lines: directions of arrival need to know where the satellites are; give --nav, and "
            "a recording that knows its time"
        )
    moving = vehicle(track, min(r.duration_s for r in recordings), store, start)
    return _Given(array, recordings, moving, lines_m, known)


def _elements(text: str) -> list[list[float]]:
    try:
        return [[float(x) for x in place.split(",")] for place in text.split(";") if place.strip()]
    except ValueError as error:
        raise ConfigError(
            f"--elements: '{text}' is not forward,right,down of each antenna, divided by ';'"
        ) from error


def _lines(text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(x) for x in text.split(",")]
    except ValueError as error:
        raise ConfigError(f"--lines: '{text}' is not a number of m for each antenna") from error


def _tracked(
    recordings: Sequence[Recording],
    arguments: argparse.Namespace,
    ui: Ui,
    settings: config.Config,
) -> list[TrackLog]:
    """Tracks of each antenna of what the reference acquires."""
    from sdr_spoof.acquisition import acquire  # noqa: PLC0415
    from sdr_spoof.tracking import track  # noqa: PLC0415

    with ui.stages("Acquiring") as progress:
        found = acquire(
            recordings[0],
            settings.acquisition,
            signals=options.signals_from(arguments, recordings[0]),
            prns=options.prns_from(arguments),
            threads=arguments.threads,
            progress=progress,
        )
    detected = [a for a in found if a.detected]
    logs = []
    for number, recording in enumerate(recordings):
        with ui.stages(f"Tracking antenna {number}") as progress:
            logs.append(
                track(
                    recording,
                    detected,
                    settings.tracking,
                    threads=arguments.threads,
                    progress=progress,
                )
            )
    return logs


def _write(
    arguments: argparse.Namespace,
    settings: config.Config,
    given: _Given,
    findings: Sequence[Finding],
) -> None:
    from sdr_spoof.report.array import array_page  # noqa: PLC0415
    from sdr_spoof.report.figures.array_scores import draw_scores  # noqa: PLC0415
    from sdr_spoof.report.page import write_page  # noqa: PLC0415
    from sdr_spoof.sinks.atomic import write_bytes  # noqa: PLC0415

    report, picture, table = (arguments.output / name for name in FILES)
    scores = draw_scores(findings)
    page = array_page(
        findings,
        given.array,
        given.moving,
        settings.array,
        name=arguments.recordings[0].name,
        known=given.known,
        calibrated=given.lines_m is not None,
        picture=scores,
    )
    used = settings.model_dump(mode="json", include={"acquisition", "tracking", "array"})
    write_page(report, page, used, force=arguments.force)
    write_bytes(picture, scores, force=arguments.force)
    write_bytes(table, _csv(findings), force=arguments.force)


def _csv(findings: Sequence[Finding]) -> bytes:
    """A row a test; those of the direction of arrival have no way."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        ["satellite", "signal", "time_s", "way_m", "score", "p_value", "threshold", "test"]
    )

    def write(f: Finding, test: str, *columns: Iterable[float | None]) -> None:
        for row in zip(*columns, strict=True):
            numbers = ["" if v is None else f"{v:.6g}" for v in (*row, f.threshold)]
            writer.writerow([f.satellite, f.signal, *numbers, test])

    for f in findings:
        write(f, "motion", f.time_s, f.way_m, f.score, f.p_value)
        if f.arrivals is not None:
            a = f.arrivals
            write(f, "arrival", a.time_s, [None] * a.time_s.size, a.score, a.p_value)
    return text.getvalue().encode("ascii")


def _outcome(findings: Sequence[Finding], arguments: argparse.Namespace, *, known: bool) -> Outcome:
    data = {
        "recordings": arguments.recordings,
        "orbits_known": known,
        "satellites": [
            {
                "satellite": f.satellite,
                "signal": f.signal,
                "verdict": f.verdict,
                "alarm_s": f.alarm_s,
                "reason": f.reason,
                "phase_noise_cycles": f.sigma_cycles if f.sigma_cycles == f.sigma_cycles else None,
                "tests": len(f.time_s),
                "arrivals": 0 if f.arrivals is None else len(f.arrivals.time_s),
            }
            for f in findings
        ],
        "output": arguments.output,
    }

    def render(console: Console) -> None:
        made = tables.table(
            "Directions by the array",
            *("satellite", "signal", "verdict", "tests", "alarm s", "why"),
            left=["satellite", "signal", "verdict", "why"],
        )
        for f in findings:
            alarm = "" if f.alarm_s is None else f"{f.alarm_s:.1f}"
            made.add_row(f.satellite, f.signal, f.verdict, str(len(f.time_s)), alarm, f.reason)
        console.print(made)
        if not known:
            console.print(
                "No orbits (--nav, and a recording that knows its time): satellites are taken to "
                "stand still, which holds for half a minute.",
                highlight=False,
            )
        if arguments.output is not None:
            console.print(f"  {arguments.output / FILES[0]}", highlight=False, soft_wrap=True)

    return Outcome(data, render)


COMMAND = Command(
    "array",
    "tell satellites from near transmitters by several antennas on a moving vehicle",
    _configure,
    _run,
    usage="REC REC REC... --elements F,R,D;... --vehicle FILE.csv [options]",
    details="Tracks every satellite on all antennas and tests whether its direction, by the "
    "carrier-phase differences and the INS's attitude, stands still as the vehicle moves on and, "
    "with calibrated lines, whether it is the satellite's. Three antennas or more, not in one "
    "line; recordings with a common clock. Writes report.html, a picture and a table.",
    examples=(
        "sdr-spoof synth array -o out/array",
        "sdr-spoof array out/array.a?.sigmf-meta --vehicle out/array.a0.vehicle.csv "
        "--elements '0,0,0;0.38,0,0;0.19,0.329,0' -o out/array-report",
        "sdr-spoof array a.sigmf-meta b.sigmf-meta c.sigmf-meta --vehicle ins.csv --nav brdc.rnx "
        "--elements '0,0,0;0.38,0,0;0.19,0.329,0' --lines 0.012,-0.004",
    ),
)
