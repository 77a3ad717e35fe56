"""``sdr-spoof validate``: the long measurements behind docs/validation.md."""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof.errors import OutputError

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable

    from rich.console import Console

    from .ui import Ui


@dataclass(frozen=True)
class _Study:
    """A module of ``sdr_spoof.studies``, of the same name."""

    last: str
    """File that it writes last."""
    sizes: Callable[[float], dict[str, float]]
    """Arguments of its ``run`` that say how long it is, for a share of the full length."""
    threaded: bool = True
    """Whether it takes a number of threads."""


STUDIES = {
    "acquisition": _Study(
        "acquisition.json",
        lambda share: {
            "searches": max(100, round(4000 * share)),
            "trials": max(10, round(240 * share)),
        },
    ),
    "tracking": _Study("tracking_jitter.json", lambda s: {"duration_s": max(6.0, 30.0 * s)}),
    "combo": _Study("combo.json", lambda s: {"seeds": max(2, round(20 * s))}),
    "fallback": _Study("fallback.json", lambda s: {"runs": max(1, round(20 * s))}, threaded=False),
    "levels": _Study("levels.json", lambda s: {"runs": max(2, round(16 * s))}, threaded=False),
    "bcnav1": _Study("bcnav1.json", lambda s: {"frames": max(100, round(2000 * s))}),
    "subframes": _Study(
        "subframes.json", lambda s: {"subframes": max(200, round(20_000 * s))}, threaded=False
    ),
    "position": _Study(
        "position.json",
        lambda s: {"duration_s": max(42.0, 60.0 * s), "starts": max(1, round(6 * s))},
    ),
    "gaps": _Study("gaps.json", lambda s: {"recordings": max(1, round(50 * s))}, threaded=False),
    "speed": _Study("speed.json", lambda s: {"repeats": max(3, round(25 * s))}, threaded=False),
}
"""Every study, by name."""


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
    if (folder / STUDIES[arguments.study].last).exists() and not arguments.force:
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
    study = STUDIES[arguments.study]
    # Only now: what the studies need is slow to import.
    module = import_module(f"sdr_spoof.studies.{arguments.study}")
    sizes: dict[str, Any] = study.sizes(arguments.scale / 100)
    if study.threaded:
        sizes["threads"] = arguments.threads or os.cpu_count() or 1
    found: dict[str, Any] = module.run(folder, progress=progress, **sizes)
    return found


COMMAND = Command(
    "validate",
    "repeat a measurement of docs/validation.md",
    _configure,
    _run,
    usage="STUDY [-o FOLDER] [options]",
    details="The full length of a study takes from minutes to hours.",
    examples=("sdr-spoof validate tracking --scale 20", "sdr-spoof validate acquisition"),
)
