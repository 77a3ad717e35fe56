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
    inner = process.outcome(demo.processed, ui)

    def render(console: Console) -> None:
        inner.render(console)
        console.print(tables.truth(demo.comparison))
        console.print(_closing(demo), highlight=False, soft_wrap=True)

    data = {**inner.data, "comparison": demo.comparison}
    return Outcome(data, render, inner.exit_code)


def _closing(demo: Demo) -> str:
    meta = demo.processed.recording.path.with_suffix(".sigmf-meta")
    size_gb = demo.processed.recording.path.stat().st_size / 1e9
    return (
        f"The recording ({size_gb:.1f} GB) is kept in {meta.parent}\n"
        f"  inspect: sdr-spoof info {meta}\n"
        f"  again:   sdr-spoof process {meta}\n"
        f"  delete:  rm {meta.with_suffix('')}.*"
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
