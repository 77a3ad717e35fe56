"""``sdr-spoof aid``: observations judged by an IMU, and a place that spoofers do not move."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from sdr_spoof import config

from . import options
from .command import Command, Outcome

if TYPE_CHECKING:
    import argparse

    from rich.console import Console

    from sdr_spoof.aided.session import Session

    from .ui import Ui

ONLY_AIDED = ("imu", "aided", "tight", "rate")
GROUPS = (*ONLY_AIDED, "pvt")
NAMES = ("aided.html", "aided.h5", "aided.csv")


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "observations",
        type=Path,
        metavar="OBSERVATIONS",
        help="RINEX observation file (3 or 4), or a result file of process or fix (.h5)",
    )
    add_imu(parser, required=True)
    parser.add_argument(
        "--nav",
        dest=config.FLAG_PREFIX + "navigation.files",
        metavar="FILE.rnx,...",
        help="RINEX navigation files; needed with a RINEX observation file",
    )
    parser.add_argument(
        "--truth",
        type=Path,
        metavar="FILE",
        help="truth of a synthesised scenario (.truth.json), drawn in the report",
    )
    options.add_output(parser, "folder for the files (default: out/<observations>)")
    config.add_flags(parser, GROUPS)


def add_imu(parser: argparse.ArgumentParser, *, required: bool) -> None:
    """Add ``--imu`` and what is short for flags of aiding."""
    parser.add_argument(
        "--imu", type=Path, metavar="FILE", required=required, help="log of the IMU (CSV)"
    )
    for flag, name, metavar, what in (
        ("--grade", "aided.grade", "NAME", "quality of the IMU"),
        ("--lever-arm", "imu.lever_arm_m", "F,R,D", "antenna from the IMU in m"),
        ("--attitude", "aided.attitude_deg", "Y,P,R", "yaw, pitch, roll at the first epoch"),
    ):
        long = config.flag_name(name.split("."))
        help_text = f"{what}; the same as {long}"
        parser.add_argument(flag, dest=config.FLAG_PREFIX + name, metavar=metavar, help=help_text)
    parser.add_argument(
        "--smooth",
        dest=config.FLAG_PREFIX + "tight.smooth",
        action="store_const",
        const="true",
        help="also estimate every epoch from what came later; the same as --tight-smooth true",
    )


def _run(arguments: argparse.Namespace, ui: Ui) -> Outcome:
    from sdr_spoof.aided.session import open_session  # noqa: PLC0415
    from sdr_spoof.pipeline import output_folder, output_paths  # noqa: PLC0415

    settings = config.from_arguments(arguments)
    out = arguments.output or Path("out") / arguments.observations.stem
    output_paths(out, NAMES, force=arguments.force)
    with output_folder(out):
        session = open_session(
            arguments.observations,
            arguments.imu,
            settings,
            truth=arguments.truth,
            stages=ui.stages,
        )
        with ui.stages("Reporting"):
            session.write(out, force=arguments.force)
    return outcome(session, out)


def outcome(session: Session, out: Path) -> Outcome:
    """What is said and printed."""
    aided = session.aided
    data = summary(session, out) | {"config": session.config}

    def render(console: Console) -> None:
        from sdr_spoof.report.aided_terminal import print_aided  # noqa: PLC0415

        print_aided(aided, console)
        for name in NAMES:
            if (out / name).exists():
                console.print(f"  {out / name}", highlight=False, soft_wrap=True, markup=False)

    return Outcome(data, render)


def summary(session: Session, out: Path) -> dict[str, Any]:
    """The JSON object."""
    aided = session.aided
    track = aided.track
    return {
        "observations": session.names[0],
        "imu": session.names[1],
        "start_utc": aided.reference.utc(),
        "span_s": aided.span_s,
        "satellites": aided.measurements.satellites,
        "verdict": aided.verdict,
        "alarms": [
            {"test": m.name, "alarm_s": m.alarm_s, "onset_s": m.onset_s, "log10_p": m.log10_p}
            for m in aided.monitors
            if m.alarm_s is not None
        ],
        "left_out": {} if track is None else track.excluded(),
        "story": aided.story,
        "error_m": session.error_m,
        "notes": session.notes,
        "files": [out / name for name in NAMES if (out / name).exists()],
    }


COMMAND = Command(
    "aid",
    "judge observations by an IMU, and leave out who does not agree",
    _configure,
    _run,
    usage="OBSERVATIONS --imu FILE [--nav FILE] [-o FOLDER] [options]",
    details="Runs a tightly coupled filter of satellites and inertial sensors, which leaves out "
    "those that lead it away, and tests of carrier-phase rates against the INS. Says since when, "
    "which satellites, how sure and how bad, or that there is not enough support, and writes "
    "aided.html, aided.h5 and aided.csv.",
    examples=(
        "sdr-spoof aid drive.rnx --imu drive.imu.csv --nav brdc.rnx --grade tactical",
        "sdr-spoof aid out/today/result.h5 --imu today.imu.csv --lever-arm 1.2,0,-2.5",
        "sdr-spoof aid ship.rnx --imu ship.imu.csv --nav brdc.rnx --attitude 90,0,0 --json",
        "sdr-spoof aid survey.rnx --imu survey.imu.csv --nav brdc.rnx --smooth",
    ),
)
