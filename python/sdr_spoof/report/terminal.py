"""The verdict in the terminal."""

from __future__ import annotations

from rich.console import Console, Group
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.records import Verdict
from sdr_spoof.report import words
from sdr_spoof.verdict import CLEAN, SPOOFED, SUSPECT

COLOURS = {
    "spoofed": "bold red",
    "suspect": "bold yellow",
    "clean": "bold green",
    "unsupported": "bold yellow",
}
MARKS = {SPOOFED: ("✖", "red"), SUSPECT: ("?", "yellow"), CLEAN: ("✔", "green")}

CLEAN_MEANS = "'Clean' means that the tests found nothing; the report says what they cannot see."


def print_verdict(
    verdict: Verdict, console: Console | None = None, config: DetectionConfig | None = None
) -> None:
    """Prints the verdict: the answer, each satellite, and what was not tested."""
    console = console or Console()
    config = config or DetectionConfig()
    colour = COLOURS[words.level(verdict)]
    lines = [Text(words.headline(verdict), style=colour)]
    for satellite in words.ordered(verdict):
        if satellite.alarms:
            lines.append(Text(words.satellite_sentence(satellite), style="bold"))
            lines.append(Text(f"  {words.alarms_sentence(satellite)}"))
            lines.append(Text(f"  How sure: {words.sureness(satellite)}."))
            lines.append(Text(f"  What to do: {words.action_sentence(satellite)}."))
    lines.append(Text(f"Tested: {words.tested_sentence(verdict, config.detectors)}"))
    console.print(Panel(Group(*lines), title="Verdict", border_style=colour, padding=(1, 2)))
    if verdict.satellites:
        console.print(_table(verdict))
    console.print(Text(CLEAN_MEANS, style="dim"))


def _table(verdict: Verdict) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("Satellite", max_width=28)
    for title in ("Verdict", "Onset", "Why"):
        table.add_column(title, no_wrap=title != "Why")
    for names, s in words.rows(verdict):
        mark, colour = MARKS.get(s.verdict, ("–", "yellow"))
        onset = f"{s.onset_s:.2f} s" if s.onset_s is not None else ""
        table.add_row(names, Text(f"{mark} {s.verdict}", style=colour), onset, s.reason)
    return table
