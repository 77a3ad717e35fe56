"""``sdr-spoof bench``: how fast this machine synthesises, acquires and tracks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--repeats",
        type=options.positive,
        default=5,
        metavar="N",
        help="runs of each measurement (default: 5)",
    )


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.bench import machine, run  # noqa: PLC0415

    here = machine()
    with ui.stages("Measuring") as progress:
        measurements = run(repeats=arguments.repeats, progress=progress)

    def render(console: Console) -> None:
        made = tables.table(
            "Speed, Msamples/s: median (lowest to highest)",
            *("stage", "threads", "channels", "total", "per channel and core", "real time"),
            left=["stage"],
        )
        for m in measurements:
            spread = f"{m.median_msps:.1f} ({m.lowest_msps:.1f} to {m.highest_msps:.1f})"
            per = f"{m.per_channel_core_msps:.1f}"
            real_time = f"{m.times_real_time:.2f} x"
            made.add_row(m.stage, str(m.threads), str(m.channels), spread, per, real_time)
        console.print(made)
        console.print(
            f"Real time is 120 Msps. {here.processor}, {here.cores} cores, "
            f"load average {here.load_average:.2f} at the start.",
            highlight=False,
        )

    return Outcome({"machine": here, "measurements": measurements}, render)


COMMAND = Command(
    "bench",
    "measure the speed of each stage on this machine",
    _configure,
    _run,
    usage="[--repeats N] [options]",
    details="Runs synthesis, acquisition and tracking on made-up samples and prints millions of "
    "samples per second.",
    examples=("sdr-spoof bench", "sdr-spoof bench --repeats 20 --json"),
)
