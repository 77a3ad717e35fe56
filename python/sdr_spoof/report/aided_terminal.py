"""The verdict of aided navigation in the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console, Group
from rich.panel import Panel
from rich.text import Text

from . import aided_words as words
from .terminal import COLOURS

if TYPE_CHECKING:
    from sdr_spoof.aided.run import Aided


def print_aided(aided: Aided, console: Console | None = None) -> None:
    """Print the answer, why, how sure, and what was not tested."""
    verdict = aided.verdict
    colour = COLOURS[words.level(verdict)]
    lines = [Text(words.headline(verdict), style=colour)]
    lines += [Text(sentence, style="bold") for sentence in words.sentences(verdict)]
    lines.append(Text(f"Why: {verdict.reason}."))
    if verdict.alarm_s is not None:
        lines.append(Text(f"How sure: {words.sureness(verdict)}."))
        lines.append(Text(f"What to do: {words.action(verdict)}."))
    lines.append(Text(f"Tested: {words.tested(verdict)}."))
    console = console or Console()
    console.print(
        Panel(Group(*lines), title="Verdict, with the IMU", border_style=colour, padding=(1, 2))
    )
    for line in aided.story:
        console.print(Text(f"  {line}"))
    for note in verdict.notes:
        console.print(Text(f"  {note}", style="dim"))
