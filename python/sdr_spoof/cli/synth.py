"""``sdr-spoof synth``: a scenario to a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.errors import ConfigError

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scenario",
        nargs="?",
        metavar="SCENARIO",
        help="what is transmitted: a TOML file, or the name of a scenario that --list shows",
    )
    parser.add_argument(
        "--list", action="store_true", help="list the scenarios that come with the package"
    )
    parser.add_argument(
        "--speed-up",
        type=float,
        metavar="N",
        help="divide all times and durations by N; rates, powers and offsets stay",
    )
    options.add_output(
        parser,
        "recording to write: <PATH>.sigmf-data, -meta, .truth.json; .imu.csv if it has an IMU, "
        ".dme.csv if it has DME stations",
    )
    options.add_threads(parser)


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    if arguments.list:
        return _list()
    for name, value in (("SCENARIO", arguments.scenario), ("--output", arguments.output)):
        if value is None:
            raise ConfigError(f"{name}: missing; give it, or --list to see what there is")
    return _synthesize(arguments, ui)


def _list() -> Outcome:
    from sdr_spoof.scenario import builtin_scenario, scenario_names  # noqa: PLC0415

    shipped = {name: builtin_scenario(name) for name in scenario_names()}
    rows = [
        {"name": name, "title": s.title, "duration_s": s.recording.duration_s}
        for name, s in shipped.items()
    ]
    return Outcome({"scenarios": rows}, lambda console: console.print(tables.scenarios(rows)))


def _synthesize(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.scenario import (  # noqa: PLC0415
        dme_path,
        find_scenario,
        imu_path,
        synthesize,
        truth_path,
    )

    scenario = find_scenario(arguments.scenario)
    if arguments.speed_up is not None:
        scenario = scenario.sped_up(arguments.speed_up)
    with ui.stages("Synthesising") as progress:
        meta = synthesize(
            scenario,
            arguments.output,
            threads=arguments.threads,
            force=arguments.force,
            progress=progress,
        )
    truth = truth_path(meta)
    imu = None if scenario.imu is None else imu_path(meta)
    dme = dme_path(meta) if scenario.dme else None

    def render(console: Console) -> None:
        console.print(f"Recording: {meta}", highlight=False, soft_wrap=True)
        console.print(f"Truth:     {truth}", highlight=False, soft_wrap=True)
        if imu is not None:
            console.print(f"IMU:       {imu}", highlight=False, soft_wrap=True)
        if dme is not None:
            console.print(f"DME:       {dme}", highlight=False, soft_wrap=True)

    data = {
        "recording": meta,
        "truth": truth,
        "imu": imu,
        "dme": dme,
        "sample_count": scenario.recording.sample_count,
        "duration_s": scenario.recording.duration_s,
    }
    return Outcome(data, render)


COMMAND = Command(
    "synth",
    "synthesise a recording from a scenario",
    _configure,
    _run,
    usage="SCENARIO -o REC [options]",
    details="Writes samples, metadata and the truth, and what an IMU reads where there is one. "
    "Ctrl-C keeps what was done so far, marked partial. SCENARIO is a file or one of those that "
    "come with the package: --list names them.",
    examples=(
        "sdr-spoof synth scenario.toml -o recording",
        "sdr-spoof synth --list",
        "sdr-spoof synth ds7 --speed-up 10 -o ds7",
    ),
)
