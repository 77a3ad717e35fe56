"""``sdr-spoof campaign``: many runs of a scenario, and what they say."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from sdr_spoof.campaign import Plan

    from .ui import Ui

_MOST_ROWS = 40
"""Lines of a table on the terminal; the files hold all."""


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("spec", type=Path, metavar="SPEC.toml", help="what to run and to vary")
    options.add_output(
        parser, "folder for the results; a campaign that was stopped in it goes on", required=True
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers",
        type=options.positive,
        metavar="N",
        help="processes (default: one per core); results do not depend on it",
    )
    where.add_argument(
        "--cluster",
        metavar="ADDRESS",
        help="run on the Dask cluster whose scheduler is at tcp://HOST:PORT instead; needs "
        "pip install 'sdr-spoof[cluster]'",
    )
    parser.add_argument(
        "--dry-run", action="store_true", help="check the file and list the points; run nothing"
    )


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.campaign import plan_campaign, run_campaign  # noqa: PLC0415
    from sdr_spoof.campaign.report import write_analysis  # noqa: PLC0415

    plan = plan_campaign(arguments.spec)
    if arguments.dry_run:
        return _listed(plan)
    with ui.paced("Running", "runs") as progress:
        results = run_campaign(
            plan,
            arguments.output,
            workers=arguments.workers,
            address=arguments.cluster,
            force=arguments.force,
            progress=progress,
        )
    with ui.stages("Analysing"):
        analysis = write_analysis(results.folder, results.table)
    data: dict[str, Any] = {
        "output": results.folder,
        "table": results.folder / "runs.h5",
        "points": len(plan.points),
        "runs": results.total,
        "found": results.found,
        "failed": results.failed,
        "detection": analysis.detection,
        "coverage": analysis.coverage,
        "files": analysis.files,
    }

    def render(console: Console) -> None:
        _print_table(console, plan, analysis.detection)
        console.print(
            f"{results.total} runs at {len(plan.points)} points in {results.folder}; "
            f"{results.failed} failed"
            + (", see the column error of runs.h5" if results.failed else ""),
            highlight=False,
        )

    return Outcome(data, render)


def _listed(plan: Plan) -> Outcome:
    points = [{"point": p.index, **dict(p.values)} for p in plan.points]

    def render(console: Console) -> None:
        made = tables.table("Points", *points[0])
        for point in points[:_MOST_ROWS]:
            made.add_row(*(tables.cell(v) for v in point.values()))
        console.print(made)
        console.print(
            f"{len(points)} points x {plan.spec.campaign.runs} runs = {plan.total} runs, "
            f"{len(plan.columns)} columns",
            highlight=False,
        )

    data = {"points": points, "runs": plan.total, "columns": [c.name for c in plan.columns]}
    return Outcome(data, render)


def _print_table(console: Console, plan: Plan, rows: list[dict[str, Any]]) -> None:
    """One line per point, attack and detector; without attacks, of the others."""
    axes = [name for name, _ in plan.points[0].values]
    rows = [row for row in rows if row["hostile"]] or rows
    names = (*axes, "what", "detector", "alarms", "95 %", "after the start")
    made = tables.table("Alarms", *names, left=[*axes, "what", "detector"])
    for column in made.columns:
        column.no_wrap = True
    for row in rows[:_MOST_ROWS]:
        latency = row["median_on_air_s"]
        made.add_row(
            *(tables.cell(row[name]) for name in axes),
            *(row["what"] or "nothing", row["detector"], f"{row['alarm']:.3f}"),
            f"{row['alarm_low']:.3f}-{row['alarm_high']:.3f}",
            "" if math.isnan(latency) else f"{latency:.2f} s",
        )
    console.print(made)
    if len(rows) > _MOST_ROWS:
        console.print(f"{len(rows) - _MOST_ROWS} lines more in detection.csv", highlight=False)


COMMAND = Command(
    "campaign",
    "run a scenario many times over a sweep of settings",
    _configure,
    _run,
    usage="SPEC.toml -o RESULTS [--workers N | --cluster ADDRESS] [options]",
    details="Varies keys of the scenario, of tracking and of detection, makes independent runs at "
    "each point, and writes them to runs.h5 with tables (CSV) and figures of detection, latency "
    "and ROC. Ctrl-C keeps what is done; the same command goes on. docs/campaigns.md explains the "
    "file.",
    examples=(
        "sdr-spoof campaign drag.toml --dry-run -o results",
        "sdr-spoof campaign drag.toml -o results --workers 8",
        "sdr-spoof campaign drag.toml -o results --cluster tcp://10.0.0.1:8786 --json",
    ),
)
