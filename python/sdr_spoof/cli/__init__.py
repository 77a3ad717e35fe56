"""The command line: ``sdr-spoof COMMAND``; one module per command.

Every command takes ``--json`` and then prints one JSON object on stdout and nothing else there;
messages and progress go to stderr. Exit codes: 0 done, 1 failed, 2 wrong usage or configuration,
130 interrupted.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
from importlib.metadata import version
from typing import TYPE_CHECKING

from pydantic import ValidationError

from sdr_spoof.errors import ConfigError, SdrSpoofError

from . import (
    acquire,
    aid,
    array,
    bench,
    campaign,
    demo,
    fix,
    info,
    process,
    reproduce,
    sequential,
    synth,
    track,
    validate,
)
from .command import INTERRUPTED, Command, Outcome, to_plain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .ui import Ui

__all__ = ["main"]

COMMANDS: tuple[Command, ...] = (
    synth.COMMAND,
    info.COMMAND,
    acquire.COMMAND,
    track.COMMAND,
    process.COMMAND,
    fix.COMMAND,
    aid.COMMAND,
    sequential.COMMAND,
    array.COMMAND,
    demo.COMMAND,
    campaign.COMMAND,
    bench.COMMAND,
    validate.COMMAND,
    reproduce.COMMAND,
)

_FLAG = re.compile(r"--[a-z][a-z-]*")
_NEGATIVE_LIST = re.compile(r"-[\d.]+,")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code and never raises for a user's mistake."""
    parser = _parser()
    arguments = parser.parse_args(_southern(sys.argv[1:] if argv is None else argv))
    if arguments.command is None:
        parser.print_help(sys.stderr)
        return 2
    from .ui import Ui  # noqa: PLC0415 - help needs none, and rich is slow to import

    ui = Ui(json_mode=arguments.json, progress=arguments.progress)
    try:
        outcome: Outcome = arguments.command.run(arguments, ui)
        if arguments.json:
            print(json.dumps(to_plain(outcome.data), allow_nan=False))
        else:
            outcome.render(ui.out)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader of our output went away: silence the interpreter's own flush at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt as stop:
        return _fail(ui, f"interrupted: {stop}" if str(stop) else "interrupted", INTERRUPTED)
    except (SdrSpoofError, ValidationError, OSError, MemoryError) as error:
        wrong_usage = isinstance(error, ConfigError | ValidationError)
        return _fail(ui, _message(error), 2 if wrong_usage else 1)
    return outcome.exit_code


class _Help(argparse.HelpFormatter):
    """Keeps the lines of the examples."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        if text.startswith("examples:"):
            return text
        return super()._fill_text(text, width, indent)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="sdr-spoof",
        description="A software-defined GNSS receiver that can tell when it is being lied to.",
        epilog="`sdr-spoof COMMAND --help` explains a command, with examples.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"sdr-spoof {version('sdr-spoof')}")
    parser.set_defaults(command=None)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for command in COMMANDS:
        sub = commands.add_parser(
            command.name,
            help=command.summary,
            usage=f"sdr-spoof {command.name} {command.usage}",
            description=f"{command.summary[0].upper()}{command.summary[1:]}. {command.details}",
            epilog="\n  ".join(["examples:", *command.examples]),
            formatter_class=_Help,
            allow_abbrev=False,
        )
        command.configure(sub)
        output = sub.add_argument_group("output")
        output.add_argument("--json", action="store_true", help="print one JSON object on stdout")
        output.add_argument(
            "--progress", action="store_true", help="show progress even if stderr is no terminal"
        )
        sub.set_defaults(command=command)
    return parser


def _southern(words: Sequence[str]) -> list[str]:
    """Words of a command line, a place such as -33.9,18.4,0 joined to its flag.

    argparse would take it for a flag itself.
    """
    joined: list[str] = []
    for word in words:
        if joined and _FLAG.fullmatch(joined[-1]) and _NEGATIVE_LIST.match(word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _fail(ui: Ui, message: str, code: int) -> int:
    ui.err.print(f"sdr-spoof: {message}", style="bold red", markup=False, highlight=False)
    return code


def _message(error: BaseException) -> str:
    if isinstance(error, MemoryError):
        return "out of memory"
    return str(error) or type(error).__name__
