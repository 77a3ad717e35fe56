"""``sdr-spoof acquire``: which satellites are in a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof import config

from . import options, tables
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    options.add_recording(parser)
    options.add_selection(parser)
    options.add_output(parser, "HDF5 file for the result")
    options.add_threads(parser)
    config.add_flags(parser, ["acquisition"])


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.acquisition import acquire  # noqa: PLC0415 - commands load what they need
    from sdr_spoof.sinks.hdf5 import Result, write_result  # noqa: PLC0415

    settings = config.from_arguments(arguments)
    options.check_output(arguments.output, force=arguments.force)
    recording = options.recording_from(arguments)
    with ui.stages("Acquiring") as progress:
        found = acquire(
            recording,
            settings.acquisition,
            signals=options.signals_from(arguments, recording),
            prns=options.prns_from(arguments),
            threads=arguments.threads,
            progress=progress,
        )
    if arguments.output is not None:
        result = Result.of(recording, settings, acquisitions=found)
        write_result(arguments.output, result, force=arguments.force)
    data = {
        "recording": recording.path,
        "format": recording.format,
        "config": settings,
        "acquisitions": found,
        "output": arguments.output,
    }

    def render(console: Console) -> None:
        console.print(tables.acquisitions(found))
        detected = sum(a.detected for a in found)
        console.print(f"{detected} of {len(found)} signals searched were found.", highlight=False)

    return Outcome(data, render)


COMMAND = Command(
    "acquire",
    "find the satellites in a recording",
    _configure,
    _run,
    usage="REC [options]",
    details="Searches the start of the recording and lists each signal found with its C/N0 "
    "(dB-Hz), Doppler (Hz, positive = approaching) and code delay.",
    examples=(
        "sdr-spoof acquire recording.sigmf-meta",
        "sdr-spoof acquire gps.bin --sample-format ci8 --sample-rate-hz 4e6 --lo-hz 1575.42e6",
        "sdr-spoof acquire recording.sigmf-meta --signals B1I,B1C --prns 19-37 --json",
    ),
)
