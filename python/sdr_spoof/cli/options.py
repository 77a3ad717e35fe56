"""Flags that several commands share."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from sdr_spoof.errors import ConfigError, OutputError
from sdr_spoof.signals import components, signal_ids, signal_spec
from sdr_spoof.sources import Recording, RecordingFormat, open_recording

_FORMAT_PREFIX = "format:"


def add_recording(parser: argparse.ArgumentParser, *, also: str = "") -> None:
    """Add the recording and the flags of its format, from the fields of RecordingFormat.

    ``also`` says what else may be named.
    """
    parser.add_argument(
        "recording",
        type=Path,
        metavar="REC",
        help=f".sigmf-meta, .sigmf-data, TOML sidecar, or raw file{also}",
    )
    section = parser.add_argument_group(
        "recording format", "for raw files; overrides what the metadata or sidecar says"
    )
    for name, field in RecordingFormat.model_fields.items():
        flag = "--" + name.replace("_", "-")
        action: dict[str, Any] = {"metavar": "VALUE"}
        if field.annotation is bool:
            action = {"action": argparse.BooleanOptionalAction, "default": None}
        help_text = (field.description or "").replace("%", "%%")
        section.add_argument(flag, dest=_FORMAT_PREFIX + name, help=help_text, **action)


def recording_from(arguments: argparse.Namespace) -> Recording:
    """Open the recording that the arguments name.

    Raises:
        RecordingError, ConfigError: as :func:`sdr_spoof.sources.open_recording`.
    """
    given = {
        key.removeprefix(_FORMAT_PREFIX): value
        for key, value in vars(arguments).items()
        if key.startswith(_FORMAT_PREFIX) and value is not None
    }
    return open_recording(arguments.recording, given)


def add_selection(parser: argparse.ArgumentParser) -> None:
    """Add ``--signals`` and ``--prns``."""
    known = ", ".join(signal_ids())
    parser.add_argument(
        "--signals",
        metavar="A,B",
        help=f"signals to look for, of {known}, or a composite such as B1C "
        "(default: all that the recording can hold)",
    )
    parser.add_argument(
        "--prns", metavar="N,N-N", help="satellites to look for, e.g. 6,19-37 (default: all)"
    )


def signals_from(arguments: argparse.Namespace, recording: Recording) -> list[str] | None:
    """Signals asked for, or None: acquisition then searches what the recording can hold.

    Raises:
        SignalError: an unknown signal, one that the recording cannot hold, or none that it can.
    """
    if arguments.signals is None:
        if not recording.signals():
            # The signal that asks for least: it raises, and says why.
            recording.check_signal(min(signal_ids(), key=_half_bandwidth_hz))
        return None
    names = [name.strip() for name in arguments.signals.split(",") if name.strip()]
    if not names:
        raise ConfigError("--signals: names no signal; leave it out to search all")
    chosen = list(dict.fromkeys(s for name in names for s in components(name)))
    for signal in chosen:
        recording.check_signal(signal)
    return chosen


def _half_bandwidth_hz(signal: str) -> float:
    return signal_spec(signal).min_half_bandwidth_hz


def prns_from(arguments: argparse.Namespace) -> list[int] | None:
    """PRNs asked for, or None for all.

    Raises:
        ConfigError: not a list of numbers and ranges.
    """
    if arguments.prns is None:
        return None
    prns: set[int] = set()
    for part in arguments.prns.split(","):
        first, _, last = part.partition("-")
        try:
            named = range(int(first), int(last or first) + 1)
        except ValueError as error:
            raise ConfigError(f"--prns: '{part}' is neither a number nor a range") from error
        if not named:
            raise ConfigError(f"--prns: '{part}' runs backwards; write {last}-{first}")
        prns |= set(named)
    return sorted(prns)


def add_threads(parser: argparse.ArgumentParser) -> None:
    """Add ``--threads``."""
    parser.add_argument(
        "--threads",
        type=positive,
        metavar="N",
        help="worker threads (default: one per core); results do not depend on it",
    )


def add_output(parser: argparse.ArgumentParser, help: str, *, required: bool = False) -> None:
    """Add ``-o`` and ``--force``."""
    parser.add_argument("-o", "--output", type=Path, metavar="PATH", required=required, help=help)
    parser.add_argument("--force", action="store_true", help="replace output that exists")


def check_output(path: Path | None, *, force: bool) -> None:
    """Refuse early, before a long run, to replace a file.

    Raises:
        OutputError: the file exists and ``force`` is not set, or its folder does not exist.
    """
    if path is None:
        return
    if path.exists() and not force:
        raise OutputError(f"{path}: exists already; add --force to replace it")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: its folder {path.parent} does not exist; create it first")


def positive(text: str) -> int:
    """Type of a flag that takes a number from 1 up."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 up")
    return int(text)
