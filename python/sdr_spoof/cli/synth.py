"""``sdr-spoof synth``: a scenario to a recording."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from . import options
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scenario", type=Path, metavar="SCENARIO.toml", help="what is transmitted")
    options.add_output(
        parser, "recording to write: <PATH>.sigmf-data, -meta and .truth.json", required=True
    )
    options.add_threads(parser)


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.scenario import load_scenario, synthesize, truth_path  # noqa: PLC0415

    scenario = load_scenario(arguments.scenario)
    with ui.stages("Synthesising") as progress:
        meta = synthesize(
            scenario,
            arguments.output,
            threads=arguments.threads,
            force=arguments.force,
            progress=progress,
        )
    truth = truth_path(meta)

    def render(console: Console) -> None:
        console.print(f"Recording: {meta}", highlight=False, soft_wrap=True)
        console.print(f"Truth:     {truth}", highlight=False, soft_wrap=True)

    data = {
        "recording": meta,
        "truth": truth,
        "sample_count": scenario.recording.sample_count,
        "duration_s": scenario.recording.duration_s,
    }
    return Outcome(data, render)


COMMAND = Command(
    "synth",
    "synthesise a recording from a scenario file",
    _configure,
    _run,
    usage="SCENARIO.toml -o REC [options]",
    details="Writes samples, metadata and the truth. Ctrl-C keeps what was done so far, marked "
    "partial. The scenarios that come with the package lie in sdr_spoof/scenario/data.",
    examples=(
        "sdr-spoof synth scenario.toml -o recording",
        "sdr-spoof synth scenario.toml -o recording --force --json",
    ),
)
