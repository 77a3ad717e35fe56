"""``sdr-spoof sequential``: pseudoranges and DME ranges tested against an INS, epoch by epoch."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof import config

from . import options
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from rich.console import Console

    from sdr_spoof.aiding.dme.judge import Judgement
    from sdr_spoof.aiding.dme.watch import Watched

    from .ui import Ui

FILES = ("sequential.png", "sequential.csv")


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "observations",
        type=Path,
        metavar="OBSERVATIONS",
        help="RINEX observation file (3 or 4), or a result file of process or fix (.h5)",
    )
    parser.add_argument(
        "--ins", type=Path, metavar="FILE.csv", required=True, help="what the INS says (CSV)"
    )
    parser.add_argument(
        "--dme", type=Path, metavar="FILE.csv", help="slant ranges to DME stations (CSV)"
    )
    parser.add_argument(
        "--nav",
        dest=config.FLAG_PREFIX + "navigation.files",
        metavar="FILE.rnx,...",
        help="RINEX navigation files; needed with a RINEX observation file",
    )
    options.add_output(parser, "folder for the picture and the table")
    config.add_flags(parser, ["sequential", "pvt"])


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.aided.session import orbits_of  # noqa: PLC0415
    from sdr_spoof.aiding import measurements  # noqa: PLC0415
    from sdr_spoof.aiding.dme.files import read_dme, read_ins  # noqa: PLC0415
    from sdr_spoof.aiding.dme.judge import judge  # noqa: PLC0415
    from sdr_spoof.aiding.dme.watch import watch  # noqa: PLC0415
    from sdr_spoof.pipeline import output_folder, output_paths  # noqa: PLC0415
    from sdr_spoof.sources.observed import open_observations  # noqa: PLC0415

    settings = config.from_arguments(arguments)
    if arguments.output is not None:
        output_paths(arguments.output, FILES, force=arguments.force)
    with ui.stages("Reading"):
        observed = open_observations(arguments.observations)
        store, notes = orbits_of(observed, settings)
        measured = measurements.of(observed.observations, store, settings.pvt)
        ins = read_ins(arguments.ins, measured.reference)
        dme = None if arguments.dme is None else read_dme(arguments.dme, measured.reference)
    with ui.stages("Testing"):
        found = judge(measured, ins, dme, settings.sequential)
        watched = watch(found, settings.sequential)
    if arguments.output is not None:
        with output_folder(arguments.output):
            _write(arguments.output, found, watched, force=arguments.force)
    return _outcome(found, arguments, (*observed.notes, *notes))


def _write(folder: Path, found: Judgement, watched: Sequence[Watched], *, force: bool) -> None:
    from sdr_spoof.report.figures.sequential import draw_sequential  # noqa: PLC0415
    from sdr_spoof.sinks.atomic import write_bytes  # noqa: PLC0415

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["test", "channel", "time_s", "sample_sigmas", "statistic", "threshold"])
    for w in watched:
        for row in zip(w.time_s, w.z, w.path, strict=True):
            writer.writerow([w.test, w.channel, *(f"{v:.6g}" for v in (*row, w.threshold))])
    write_bytes(folder / FILES[0], draw_sequential(found, tuple(watched)), force=force)
    write_bytes(folder / FILES[1], text.getvalue().encode("ascii"), force=force)


def _outcome(found: Judgement, arguments: argparse.Namespace, notes: Sequence[str]) -> Outcome:
    isolation = found.isolation
    named = isolation is not None and isolation.satellites is not None
    data: dict[str, Any] = {
        "observations": arguments.observations,
        "verdict": "spoofed" if found.alarm_s is not None else verdict(found),
        "alarm_s": found.alarm_s,
        "ins_captured": found.captured,
        "satellites": found.spoofed if named else None,
        "unique": None if isolation is None else isolation.unique,
        "fix_off_m": None if isolation is None else isolation.before_m,
        "fix_off_without_m": None if isolation is None else isolation.after_m,
        "alarms": [
            {
                "test": t.test,
                "channel": t.channel,
                "alarm_s": t.decided.alarm_s,
                "onset_s": t.decided.onset_s,
                "statistic": t.decided.statistic,
                "threshold": t.decided.threshold,
            }
            for t in found.tested
            if t.decided is not None
        ],
        "tested": len([t for t in found.tested if not t.note]),
        "notes": [*notes, *found.notes],
        "output": arguments.output,
    }

    def render(console: Console) -> None:
        for line in words(data):
            console.print(line, highlight=False, soft_wrap=True, markup=False)

    return Outcome(data, render)


def verdict(found: Judgement) -> str:
    """Of a flight without an alarm."""
    judged = any(not t.note for t in found.tested)
    return "clean" if judged else "not enough support"


def words(data: dict[str, Any]) -> list[str]:
    """What was found, a line each."""
    lines = [f"Verdict: {data['verdict']}"]
    if data["alarm_s"] is not None:
        lines.append(f"First alarm at {data['alarm_s']:.1f} s")
        if data["ins_captured"]:
            lines.append("DME contradicts the INS: it follows the spoofer and cannot be trusted")
        if data["satellites"]:
            lines.append(f"Leave out: {', '.join(data['satellites'])}")
        elif data["satellites"] is None:
            lines.append("No set of satellites explains it: trust none")
    for alarm in data["alarms"]:
        size = f"{alarm['statistic']:.1f} over {alarm['threshold']:.1f}"
        lines.append(f"  {alarm['test']}, {alarm['channel']}: {alarm['alarm_s']:.1f} s, {size}")
    return [*lines, *(f"Note: {note}" for note in data["notes"])]


COMMAND = Command(
    "sequential",
    "test pseudoranges and DME ranges against an INS, and name the satellites",
    _configure,
    _run,
    usage="OBSERVATIONS --ins FILE [--dme FILE] [--nav FILE] [-o FOLDER] [options]",
    details="Compares each pseudorange with what the position of an INS predicts, the satellites "
    "with each other, and DME with the INS, gathers evidence by a sequential rule whose false "
    "alarms are calibrated, and finds the smallest set of satellites that explains an alarm.",
    examples=(
        "sdr-spoof sequential flight.rnx --ins flight.ins.csv --dme flight.dme.csv --nav brdc.rnx",
        "sdr-spoof sequential out/today/result.h5 --ins today.ins.csv --sequential-rule cusum",
    ),
)
