"""``sdr-spoof demo``: synthesise a recording with a spoofer, then find it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof import config

from . import options, process, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from sdr_spoof.pipeline import Demo

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    options.add_output(parser, "folder for everything (default: out/demo)")
    options.add_threads(parser)
    config.add_flags(parser, ["acquisition", "tracking", "detection"])


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof import pipeline  # noqa: PLC0415

    demo = pipeline.demo(
        config.from_arguments(arguments),
        out=arguments.output or Path("out") / "demo",
        threads=arguments.threads,
        force=arguments.force,
        stages=ui.stages,
    )
    inner = process.outcome(demo.processed, ui, files=False)
    agrees = all(c.agrees for c in demo.comparison)

    def render(console: Console) -> None:
        inner.render(console)
        console.print()
        console.print(tables.truth(demo.comparison))
        for line in filter(None, map(tables.timeline, demo.comparison)):
            console.print(line, highlight=False)
        if not agrees:
            console.print("The verdict is NOT what was synthesised.", style="bold red")
        console.print(f"\n{_closing(demo)}", highlight=False, soft_wrap=True)

    data = {**inner.data, "comparison": demo.comparison, "agrees": agrees}
    return Outcome(data, render, inner.exit_code or int(not agrees))


def _closing(demo: Demo) -> str:
    from .ui import program  # noqa: PLC0415 - rich is slow to import

    data = demo.processed.recording.path
    meta, name = data.with_suffix(".sigmf-meta"), program()
    return (
        f"{process.outputs(demo.processed)}\n"
        f"Recording: {data}  ({data.stat().st_size / 1e9:.1f} GB)\n"
        f"  inspect it: {name} info {meta}\n"
        f"  process it: {name} process {meta} -o {meta.parent / 'again'}\n"
        f"  keep it:    it stays until the demo is run again; move it elsewhere to keep it\n"
        f"  delete it:  rm {data.with_suffix('')}.*"
    )


COMMAND = Command(
    "demo",
    "synthesise a spoofed recording and find the spoofer",
    _configure,
    _run,
    usage="[-o FOLDER] [options]",
    details="Writes 12 s of B1I and B1C at 120 Msamples/s (1.4 GB), in which the B1C of one "
    "satellite is taken over, processes the file as if it were unknown, and compares the verdict "
    "with the truth.",
    examples=("sdr-spoof demo", "sdr-spoof demo -o /tmp/demo --force"),
)
