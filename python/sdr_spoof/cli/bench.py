"""``sdr-spoof bench``: how fast this machine receives, acquires and synthesises."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof.errors import ConfigError

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from sdr_spoof.bench import Settings

    from .ui import Ui

_QUICK: dict[str, Any] = {
    "msps": (5,),
    "stages": ("receiver", "engine", "channel"),
    "repeats": 2,
    "recording_s": 2.0,
    "engine_s": 0.1,
}


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--quick",
        action="store_true",
        help="a few seconds: receiver and engine at 5 Msps, twice each",
    )
    parser.add_argument(
        "--rate", metavar="MSPS,MSPS", help="sample rates, of 5, 25, 60 and 120 (default: all)"
    )
    parser.add_argument(
        "--threads", metavar="N,N", help="numbers of threads (default: 1, 2, 4 ... one per core)"
    )
    parser.add_argument(
        "--stages",
        metavar="A,B",
        help="of receiver, engine, channel (cost of the 25th), acquisition and synthesis "
        "(default: all)",
    )
    parser.add_argument(
        "--level",
        metavar="NAME",
        help="vector instructions: portable, avx2 or avx512 (default: the best, and the receiver "
        "with the portable ones too)",
    )
    parser.add_argument(
        "--repeats",
        type=options.positive,
        metavar="N",
        help="timed runs of each measurement, after one that is not timed (default: 5)",
    )
    parser.add_argument(
        "--seconds",
        type=options.positive,
        metavar="S",
        help="length of the receiver's recordings (default: 4, which take 1 GB)",
    )
    parser.add_argument(
        "--folder",
        type=Path,
        metavar="PATH",
        help="keep the recordings here, and use those that are there (default: a temporary folder)",
    )
    parser.add_argument(
        "--markdown", action="store_true", help="print the tables of docs/validation.md instead"
    )


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.bench import load_average, machine, report, run  # noqa: PLC0415

    settings = _settings(arguments)
    here = machine()
    measurements = run(settings, stages=ui.stages)
    load_after = load_average()

    def render(console: Console) -> None:
        if arguments.markdown:
            text = report.markdown(here, load_after, measurements)
            console.print(text, soft_wrap=True, highlight=False, markup=False)
            return
        for section in report.sections(here, measurements):
            made = tables.table(section.title, *section.columns, left=section.columns[:1])
            for row in section.rows:
                made.add_row(*row)
            console.print(made)
        console.print(report.NOTES + report.machine_line(here, load_after), highlight=False)

    data = {"machine": here, "load_average_after": load_after, "measurements": measurements}
    return Outcome(data, render)


def _settings(arguments: argparse.Namespace) -> Settings:
    from sdr_spoof import _core  # noqa: PLC0415
    from sdr_spoof.bench import Settings  # noqa: PLC0415

    quick = {**_QUICK, "level": _core.simd_level()} if arguments.quick else {}
    given: dict[str, Any] = {
        "msps": _numbers("--rate", arguments.rate),
        "threads": _numbers("--threads", arguments.threads),
        "stages": arguments.stages and tuple(s.strip() for s in arguments.stages.split(",")),
        "level": arguments.level,
        "repeats": arguments.repeats,
        "recording_s": arguments.seconds,
        "folder": arguments.folder,
    }
    chosen = {name: value for name, value in given.items() if value is not None}
    return Settings(**{**quick, **chosen})


def _numbers(flag: str, text: str | None) -> tuple[int, ...] | None:
    if text is None:
        return None
    parts = [part.strip() for part in text.split(",")]
    if not all(part.isdecimal() and int(part) for part in parts):
        raise ConfigError(f"{flag}: '{text}' is not a list of whole numbers from 1 up")
    return tuple(int(part) for part in parts)


COMMAND = Command(
    "bench",
    "measure the speed of each stage on this machine",
    _configure,
    _run,
    usage="[--quick] [--rate MSPS,MSPS] [--threads N,N] [options]",
    details="Makes recordings (1 GB in a temporary folder), receives them, and prints how many "
    "times faster than real time that is, for 1 thread up to one per core. Takes some minutes; "
    "leave the machine alone meanwhile.",
    examples=(
        "sdr-spoof bench --quick",
        "sdr-spoof bench --rate 25,120 --threads 1 --folder /tmp/recordings",
        "sdr-spoof bench --json",
    ),
)
