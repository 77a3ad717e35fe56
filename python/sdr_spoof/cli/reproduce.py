"""``sdr-spoof reproduce``: tables and figures of a published study, made again."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from sdr_spoof.reproduce import Reproduction

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "study", metavar="STUDY", help="which study: combo, ins-rate, ship, sprt-dme or array"
    )
    options.add_output(parser, "folder for tables, figures and report (default: out/STUDY)")
    parser.add_argument(
        "--quick", action="store_true", help="few Monte Carlo runs: under half a minute"
    )
    parser.add_argument(
        "--runs",
        type=options.positive,
        metavar="N",
        help="runs of each point (default: the study's own number)",
    )
    parser.add_argument(
        "--seed",
        type=options.positive,
        default=0,
        metavar="N",
        help="fresh random numbers (ship): what was chosen was chosen without them in view",
    )
    options.add_threads(parser)


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof import reproduce  # noqa: PLC0415 - scipy and matplotlib are slow to import

    study = reproduce.find(arguments.study)
    folder = arguments.output or Path("out") / study.name
    made = reproduce.reproduce(
        study.name,
        folder,
        quick=arguments.quick,
        runs=arguments.runs,
        seed=arguments.seed,
        threads=arguments.threads or os.cpu_count() or 1,
        force=arguments.force,
        stages=ui.stages,
    )
    data = {**reproduce.summary(made), "output": folder}
    return Outcome(data, lambda console: _render(console, made, folder), int(not made.met))


def _render(console: Console, made: Reproduction, folder: Path) -> None:
    from sdr_spoof.reproduce.output import cell, limits  # noqa: PLC0415

    table = tables.table(made.study.title, "part", "numbers met", left=["part"])
    for section in made.sections:
        if section.numbers:
            met = sum(n.met for n in section.numbers)
            table.add_row(section.title, f"{met} of {len(section.numbers)}")
    console.print(table)
    for n in made.numbers:
        if not n.met:
            text = f"NOT met: {n.what} is {cell(n.value)} {n.unit}, accepted {limits(n)}"
            console.print(text, style="bold red", highlight=False)
    for section in made.sections:
        for sentence in section.skipped:
            console.print(sentence, highlight=False)
    console.print(f"Report: {folder / made.study.name}.html", highlight=False, soft_wrap=True)


COMMAND = Command(
    "reproduce",
    "make the tables and figures of a published study again",
    _configure,
    _run,
    usage="STUDY [-o FOLDER] [options]",
    details="Writes CSV tables, PNG figures, one HTML report and a summary to the folder. The "
    "exit code is 1 if an acceptance number is not met.",
    examples=("sdr-spoof reproduce combo --quick", "sdr-spoof reproduce combo -o study --json"),
)
