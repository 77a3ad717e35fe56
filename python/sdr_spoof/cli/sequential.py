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
    from sdr_spoof.nav.time import GnssTime

    from .ui import Ui

FILES = ("report.html", "sequential.png", "sequential.csv")


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
    parser.add_argument(
        "--ins-grade",
        dest=config.FLAG_PREFIX + "sequential.ins_grade",
        metavar="NAME",
        help="quality of a free INS, whose drift is then learnt; the same as "
        "--sequential-ins-grade; how well it was aligned is in [rate] of --config",
    )
    options.add_output(parser, "folder for the report, the picture and the table")
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
        found = judge(measured, ins, dme, settings.sequential, settings.rate)
        watched = watch(found, settings.sequential)
    notes = (*observed.notes, *notes)
    if arguments.output is not None:
        with ui.stages("Reporting"), output_folder(arguments.output):
            _write(arguments, settings, found, watched, notes, measured.reference)
    return _outcome(found, arguments, notes)


def _write(
    arguments: argparse.Namespace,
    settings: config.Config,
    found: Judgement,
    watched: Sequence[Watched],
    notes: Sequence[str],
    reference: GnssTime | None,
) -> None:
    from sdr_spoof.report.figures.sequential import draw_sequential  # noqa: PLC0415
    from sdr_spoof.report.page import write_page  # noqa: PLC0415
    from sdr_spoof.report.sequential import sequential_page  # noqa: PLC0415
    from sdr_spoof.sinks.atomic import write_bytes  # noqa: PLC0415

    report, picture, table = (arguments.output / name for name in FILES)
    drawn = draw_sequential(found, tuple(watched))
    given = [path.name for path in (arguments.ins, arguments.dme) if path is not None]
    page = sequential_page(
        found,
        watched,
        settings.sequential,
        name=arguments.observations.name,
        by=given,
        reference=reference,
        picture=drawn,
        notes=notes,
    )
    groups = {"sequential", "pvt", "navigation"}
    groups |= {"rate"} if settings.sequential.ins_grade is not None else set()
    used = settings.model_dump(mode="json", include=groups)
    force = arguments.force
    write_page(report, page, used, force=force)
    write_bytes(picture, drawn, force=force)
    write_bytes(table, _csv(watched), force=force)


def _csv(watched: Sequence[Watched]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["test", "channel", "time_s", "sample_sigmas", "statistic", "threshold"])
    for w in watched:
        for row in zip(w.time_s, w.z, w.path, strict=True):
            writer.writerow([w.test, w.channel, *(f"{v:.6g}" for v in (*row, w.threshold))])
    return text.getvalue().encode("ascii")


def _outcome(found: Judgement, arguments: argparse.Namespace, notes: Sequence[str]) -> Outcome:
    from sdr_spoof.report import sequential_words as words  # noqa: PLC0415

    isolation = found.isolation
    named = isolation is not None and isolation.satellites is not None
    out = arguments.output
    data: dict[str, Any] = {
        "observations": arguments.observations,
        "verdict": words.verdict(found),
        "alarm_s": found.alarm_s,
        "ins_captured": found.captured,
        "satellites": found.spoofed if named else None,
        "unique": None if isolation is None else isolation.unique,
        "fix_off_m": None if isolation is None else isolation.before_m,
        "fix_off_without_m": None if isolation is None else isolation.after_m,
        "alarms": [
            {
                "test": tested.test,
                "channel": tested.channel,
                "alarm_s": decided.alarm_s,
                "onset_s": decided.onset_s,
                "statistic": decided.statistic,
                "threshold": decided.threshold,
            }
            for decided, tested in words.alarms(found)
        ],
        "tested": len([t for t in found.tested if not t.note]),
        "notes": [*notes, *found.notes],
        "output": out,
    }

    def render(console: Console) -> None:
        lines = [f"Verdict: {data['verdict']}", *words.sentences(found)]
        if found.alarm_s is not None:
            lines.append(f"What to do: {words.action(found)}")
        lines += [f"  {line}" for line in words.alarm_lines(found)]
        lines += [f"Note: {note}" for note in data["notes"]]
        lines += [f"  {out / FILES[0]}"] if out is not None else []
        for line in lines:
            console.print(line, highlight=False, soft_wrap=True, markup=False)

    return Outcome(data, render)


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
        "sdr-spoof sequential flight.rnx --ins flight.ins.csv --nav brdc.rnx --ins-grade "
        "navigation --sequential-ins-aligned-s 600",
    ),
)
