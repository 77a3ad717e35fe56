"""``sdr-spoof process``: from a recording to a verdict and a report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sdr_spoof import config
from sdr_spoof.errors import AidingError, SdrSpoofError

from . import aid, options, tables
from .command import INTERRUPTED, Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from sdr_spoof.aiding.imu.readers import ImuReading
    from sdr_spoof.pipeline import Processed

    from .ui import Ui


def _configure(parser: argparse.ArgumentParser) -> None:
    options.add_recording(parser)
    options.add_selection(parser)
    options.add_output(parser, "folder for report.html and result.h5 (default: out/<recording>)")
    options.add_threads(parser)
    aid.add_imu(parser, required=False)
    stages = ["acquisition", "tracking", "detection", "navigation", "observables", "pvt"]
    config.add_flags(parser, [*stages, *aid.ONLY_AIDED])


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.aiding.imu.readers import read_imu  # noqa: PLC0415
    from sdr_spoof.pipeline import output_paths, process  # noqa: PLC0415

    settings = config.from_arguments(arguments)
    recording = options.recording_from(arguments)
    out = arguments.output or Path("out") / recording.path.stem
    imu = None
    if arguments.imu is not None:
        # What is wrong with it is said before the long work.
        imu = read_imu(arguments.imu, settings.imu)
        output_paths(out, aid.NAMES, force=arguments.force)
    processed = process(
        recording,
        settings,
        out=out,
        signals=options.signals_from(arguments, recording),
        prns=options.prns_from(arguments),
        threads=arguments.threads,
        force=arguments.force,
        stages=ui.stages,
    )
    said = outcome(processed, ui)
    return said if imu is None else _aided(said, processed, imu, arguments, ui)


def _aided(
    said: Outcome,
    processed: Processed,
    imu: ImuReading,
    arguments: argparse.Namespace,
    ui: Ui,
) -> Outcome:
    """The same, and what the IMU says of it.

    Raises:
        AidingError: there are no observations that the IMU could judge.
    """
    from sdr_spoof.aided.session import session_of  # noqa: PLC0415
    from sdr_spoof.sources.observed import Observed  # noqa: PLC0415

    located, settings, out = processed.located, processed.config, processed.report_path.parent
    if located is None:
        raise AidingError(f"--imu: there are no observations to judge: {processed.why_not_located}")
    observed = Observed(located.observations, located.navigation, processed.verdict)
    names = processed.recording.path.name, arguments.imu.name
    try:
        session = session_of(observed, imu, settings, names=names, stages=ui.stages)
    except SdrSpoofError as error:
        known = f"what the receiver itself found is in {processed.report_path}"
        raise AidingError(f"{error}; {known}") from error
    with ui.stages("Reporting"):
        session.write(out, force=arguments.force)
    more = aid.outcome(session, out)

    def render(console: Console) -> None:
        said.render(console)
        more.render(console)

    return Outcome(said.data | {"aided": more.data}, render, said.exit_code)


def outputs(processed: Processed) -> str:
    """Where the results are."""
    return (
        f"Report: {processed.report_path}  (open it in a browser)\n"
        f"Result: {processed.result_path}  (every number, HDF5)"
    )


def outcome(processed: Processed, ui: Ui, *, files: bool = True) -> Outcome:
    """Outcome of a processed recording, shared by ``process`` and ``demo``."""
    from sdr_spoof.positioning.summary import sentences, summarise  # noqa: PLC0415
    from sdr_spoof.report import print_verdict  # noqa: PLC0415

    if processed.log.partial:
        ui.note(f"interrupted: the results are partial, up to {processed.log.duration_s:.3f} s")
    why_not = processed.why_not_located
    position = summarise(processed.located) if processed.located is not None else None
    data = {
        "recording": processed.recording.path,
        "format": processed.recording.format,
        "config": processed.config,
        "partial": processed.log.partial,
        "duration_s": processed.log.duration_s,
        "acquisitions": processed.acquisitions,
        "second_peaks": processed.log.second_peaks,
        "verdict": processed.verdict,
        "position": position,
        "no_position": why_not or None,
        "result": processed.result_path,
        "report": processed.report_path,
    }

    def render(console: Console) -> None:
        console.print(tables.acquisitions(processed.acquisitions))
        console.print(tables.tracks(processed.log.signals))
        print_verdict(processed.verdict, console, processed.config.detection)
        if files:
            told = sentences(position) if position else [f"No position: {why_not}"]
            console.print("\n".join(["", *told]), highlight=False, soft_wrap=True, markup=False)
            console.print(f"\n{outputs(processed)}", highlight=False, soft_wrap=True)

    return Outcome(data, render, INTERRUPTED if processed.log.partial else 0)


COMMAND = Command(
    "process",
    "acquire, track, detect spoofing, and write a report",
    _configure,
    _run,
    usage="REC [-o FOLDER] [options]",
    details="Ends with a verdict for each satellite, and with positions where the recording "
    "allows, and writes FOLDER/report.html, for people, and FOLDER/result.h5, with every number. "
    "Ctrl-C while it tracks keeps what was done so far, marked partial.",
    examples=(
        "sdr-spoof process recording.sigmf-meta",
        "sdr-spoof process b1.bin --sample-format ri8 --sample-rate-hz 120e6 --lo-hz 1538.259e6",
        "sdr-spoof process recording.sigmf-meta -o out/today --force --json",
        "sdr-spoof process ship.sigmf-meta --imu ship.imu.csv --grade ship-a",
    ),
)
