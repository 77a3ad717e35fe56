"""Consoles and progress bars: results on stdout, everything else on stderr."""

from __future__ import annotations

import shutil
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from sdr_spoof.progress import silent

from .pace import Pace

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

    from sdr_spoof.progress import Progress as ProgressCallback

NAME = "sdr-spoof"
_LINE_EVERY_S = 60.0
"""Between two lines of progress in a log."""
_WIDTH = 100
"""Columns where the output is no terminal, so that tables are not cut."""


def program() -> str:
    """How the user can call this program from here."""
    called = Path(sys.argv[0])
    found = shutil.which(NAME)
    if called.name != NAME or (found and Path(found).resolve() == called.resolve()):
        return NAME
    inside = called.absolute().is_relative_to(Path.cwd())
    return str(called.absolute().relative_to(Path.cwd()) if inside else called)


class Ui:
    """Where a command prints."""

    def __init__(self, *, json_mode: bool = False, progress: bool = False) -> None:
        """Progress is shown on a terminal, or wherever stderr goes if ``progress`` is set."""
        self.json_mode = json_mode
        self.out = Console(file=sys.stdout, width=None if sys.stdout.isatty() else _WIDTH)
        self.err = Console(file=sys.stderr, soft_wrap=True)
        self._show = progress or sys.stderr.isatty()
        self._forced = progress

    def note(self, text: str) -> None:
        """Print a line on stderr."""
        self.err.print(text, highlight=False, markup=False)

    def stages(self, label: str) -> AbstractContextManager[ProgressCallback | None]:
        """Show a bar for one stage; a :data:`sdr_spoof.progress.Stages`."""
        if self._show:
            return self._bar(label)
        return silent(label) if self.json_mode else self._line(label)

    @contextmanager
    def paced(self, label: str, unit: str) -> Iterator[ProgressCallback | None]:
        """Show how many are done, the rate and the remaining time; in a log, a line a minute."""
        pace = Pace(unit)
        if self._show:
            with self._bars(TextColumn("{task.fields[pace]}")) as bars:
                task = bars.add_task(label, total=1.0, pace="")

                def show(done: float, total: float) -> None:
                    pace.note(done, total)
                    bars.update(task, completed=done, total=total, pace=str(pace))

                yield show
        elif self.json_mode:
            yield None
        else:
            yield self._log(label, pace)
            self.note(f"{label}: {pace}")

    def _log(self, label: str, pace: Pace) -> ProgressCallback:
        """Prints a line now and then."""
        last = time.monotonic()

        def show(done: float, total: float) -> None:
            nonlocal last
            pace.note(done, total)
            if time.monotonic() - last >= _LINE_EVERY_S:
                last = time.monotonic()
                self.note(f"{label}: {pace}")

        return show

    @contextmanager
    def _line(self, label: str) -> Iterator[None]:
        """One line per stage, for logs."""
        start = time.monotonic()
        yield
        self.note(f"{label}: {time.monotonic() - start:.1f} s")

    @contextmanager
    def _bar(self, label: str) -> Iterator[ProgressCallback]:
        with self._bars(TimeElapsedColumn(), TimeRemainingColumn()) as bars:
            task = bars.add_task(label, total=1.0)
            yield lambda done, total: bars.update(task, completed=done, total=total)

    def _bars(self, *columns: ProgressColumn) -> Progress:
        first = (
            TextColumn("{task.description:<14}"),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %"),
        )
        console = Console(file=sys.stderr, force_terminal=self._forced or None)
        return Progress(*first, *columns, console=console)
