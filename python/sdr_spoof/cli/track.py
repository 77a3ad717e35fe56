"""``sdr-spoof track``: follow code and carrier of what acquisition found."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof import config
from sdr_spoof.records import State

from . import options, tables
from .command import INTERRUPTED, Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from sdr_spoof.records import SignalTrack

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    options.add_recording(parser)
    options.add_selection(parser)
    options.add_output(parser, "HDF5 file for the result")
    options.add_threads(parser)
    config.add_flags(parser, ["acquisition", "tracking"])


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.receive import receive  # noqa: PLC0415
    from sdr_spoof.sinks.hdf5 import Result, write_result  # noqa: PLC0415

    settings = config.from_arguments(arguments)
    options.check_output(arguments.output, force=arguments.force)
    recording = options.recording_from(arguments)
    found, log = receive(
        recording,
        settings,
        options.signals_from(arguments, recording),
        options.prns_from(arguments),
        arguments.threads,
        ui.stages,
        rows_in=arguments.output.parent if arguments.output else Path(tempfile.gettempdir()),
    )
    if arguments.output is not None:
        result = Result.of(recording, settings, acquisitions=found, log=log)
        write_result(arguments.output, result, force=arguments.force)
    if log.partial:
        ui.note(f"interrupted: the results are partial, up to {log.duration_s:.3f} s")

    def render(console: Console) -> None:
        console.print(tables.tracks(log.signals))
        console.print(f"{log.duration_s:.3f} s of signal tracked.", highlight=False)

    data = {
        "recording": recording.path,
        "format": recording.format,
        "config": settings,
        "acquisitions": found,
        "duration_s": log.duration_s,
        "partial": log.partial,
        "tracks": [_summary(t) for t in log.signals],
        "combos": [{"prn": c.prn, "epochs": c.epochs} for c in log.combos],
        "output": arguments.output,
    }
    return Outcome(data, render, INTERRUPTED if log.partial else 0)


def _summary(track: SignalTrack) -> dict[str, Any]:
    """The track's last epoch; the whole of it is in the HDF5 file."""
    summary: dict[str, Any] = {
        "signal": track.signal,
        "prn": track.prn,
        "epochs": track.epochs,
    }
    if track.epochs:
        last = track.part(track.epochs - 1, track.epochs)
        summary |= {
            "time_s": last.time_s[0],
            "state": State(int(last.state[0])),
            "cn0_dbhz": last.cn0_dbhz[0],
            "doppler_hz": last.doppler_hz[0],
            "code_phase_chips": last.code_phase_chips[0],
            "carrier_phase_cycles": last.carrier_phase_cycles[0],
            "phase_lock": last.phase_lock[0],
        }
    return summary


COMMAND = Command(
    "track",
    "acquire, then track code and carrier",
    _configure,
    _run,
    usage="REC [-o RESULT.h5] [options]",
    details="Lists the state of each signal at the end; -o keeps every epoch. Ctrl-C while it "
    "tracks keeps what was done so far, marked partial.",
    examples=(
        "sdr-spoof track recording.sigmf-meta -o tracks.h5",
        "sdr-spoof track recording.sigmf-meta --prns 27 --tracking-dll-bandwidth-hz 0.5",
    ),
)
