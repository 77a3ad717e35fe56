"""``sdr-spoof validate``: the long measurements behind docs/validation.md."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof.errors import OutputError

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from .ui import Ui

STUDIES = {
    "acquisition": "acquisition.json",
    "tracking": "tracking_jitter.json",
    "combo": "combo.json",
    "fallback": "fallback.json",
    "levels": "levels.json",
    "bcnav1": "bcnav1.json",
    "speed": "speed.json",
}
"""Name of a study, and the file that it writes last."""


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("study", choices=STUDIES, help="what to measure")
    options.add_threads(parser)
    options.add_output(parser, "folder for tables and figures (default: out/validate)")
    parser.add_argument(
        "--scale",
        type=options.positive,
        default=100,
        metavar="PERCENT",
        help="length of the study, of what docs/validation.md shows (default: 100)",
    )


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    folder = arguments.output or Path("out/validate")
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is not a folder; name another with -o")
    if (folder / STUDIES[arguments.study]).exists() and not arguments.force:
        raise OutputError(f"{folder}: holds such results already; add --force to replace them")
    with ui.stages(f"Measuring {arguments.study}") as progress:
        result = _study(arguments, folder, progress)
    rows = [row for table in result.values() if isinstance(table, list) for row in table]

    def render(console: Console) -> None:
        for name, table in result.items():
            if isinstance(table, list):
                made = tables.table(name, *table[0])
                for row in table:
                    made.add_row(*(tables.cell(v) for v in row.values()))
                console.print(made)
        console.print(f"{len(rows)} rows and a figure in {folder}", highlight=False)

    return Outcome({"study": arguments.study, "output": folder, **result}, render)


def _study(arguments: argparse.Namespace, folder: Path, progress: Any) -> dict[str, Any]:
    share = arguments.scale / 100
    if arguments.study == "acquisition":
        from sdr_spoof.studies import acquisition  # noqa: PLC0415 - scipy is slow to import

        return acquisition.run(
            folder,
            searches=max(100, round(4000 * share)),
            trials=max(10, round(240 * share)),
            threads=arguments.threads or 2,
            progress=progress,
        )
    if arguments.study == "speed":
        from sdr_spoof.studies import speed  # noqa: PLC0415

        return speed.run(folder, repeats=max(3, round(25 * share)), progress=progress)
    if arguments.study == "combo":
        from sdr_spoof.studies import combo  # noqa: PLC0415

        seeds = max(2, round(20 * share))
        return combo.run(folder, seeds=seeds, threads=arguments.threads, progress=progress)
    if arguments.study == "bcnav1":
        from sdr_spoof.studies import bcnav1  # noqa: PLC0415

        frames = max(100, round(2000 * share))
        return bcnav1.run(folder, frames=frames, threads=arguments.threads, progress=progress)
    if arguments.study == "fallback":
        from sdr_spoof.studies import fallback  # noqa: PLC0415

        return fallback.run(folder, runs=max(1, round(20 * share)), progress=progress)
    if arguments.study == "levels":
        from sdr_spoof.studies import levels  # noqa: PLC0415

        return levels.run(folder, runs=max(2, round(16 * share)), progress=progress)
    from sdr_spoof.studies import tracking  # noqa: PLC0415

    duration_s = max(6.0, 30.0 * share)
    return tracking.run(folder, duration_s=duration_s, threads=arguments.threads, progress=progress)


COMMAND = Command(
    "validate",
    "repeat a measurement of docs/validation.md",
    _configure,
    _run,
    usage="STUDY [-o FOLDER] [options]",
    details="The full length of a study takes from minutes to hours.",
    examples=("sdr-spoof validate tracking --scale 20", "sdr-spoof validate acquisition"),
)
