"""Processes that draw pictures beside the receiver.

A picture is a pure function of its numbers, so it does not matter who draws it: whoever asks for
one that no process has begun draws it itself, and so it does where a process fails or hangs; an
error of the picture then comes as if there were none. The processes are plain interpreters fed
through pipes, so that they need nothing of the program that uses this package (no ``__main__``
guard), do not see Ctrl-C, and end when their pipe closes, however that program ends.
"""

from __future__ import annotations

import base64
import json
import os
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, Protocol

from .figures.sheet import Sheets

if TYPE_CHECKING:
    from collections.abc import Sequence
    from concurrent.futures import Future
    from typing import Self

MOST = 3
"""Processes: a report has some twenty pictures, and each process loads the libraries first."""
PATIENCE_S = 1.0
"""Longer than any picture takes, for one that a process has begun."""
_START = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "from sdr_spoof.report.drawer import main; main()"
)


class Drawing(Protocol):
    """All that a picture shows; goes through a pipe."""

    def png(self, sheets: Sheets) -> bytes:
        """Draw it; the same bytes each time."""


class Picture:
    """A picture that was asked for."""

    def __init__(self, drawing: Drawing, sheets: Sheets, elsewhere: Future[bytes] | None) -> None:
        """``elsewhere`` is what a process may make of it."""
        self.drawing, self._sheets, self._elsewhere = drawing, sheets, elsewhere
        self._png: bytes | None = None

    def drop(self) -> bool:
        """Take it from the processes; whether none had begun it."""
        return self._png is None and (self._elsewhere is None or self._elsewhere.cancel())

    def draw_unless_begun(self) -> None:
        """Draw it here if no process has begun to."""
        if self.drop():
            self._png = self.drawing.png(self._sheets)

    def png(self) -> bytes:
        """The picture; waits for the process that is drawing it."""
        self.draw_unless_begun()
        if self._png is None and self._elsewhere is not None:
            # The process has ended, or does not answer (a TimeoutError is an OSError).
            with suppress(OSError, EOFError, pickle.PickleError):
                self._png = self._elsewhere.result(PATIENCE_S)
        if self._png is None:
            self._png = self.drawing.png(self._sheets)
        return self._png

    @property
    def uri(self) -> str:
        """The picture as an address that holds all of it."""
        return "data:image/png;base64," + base64.b64encode(self.png()).decode("ascii")


class Crew:
    """So many processes, ready to draw; a context, at whose end they are gone."""

    def __init__(self, count: int = 0) -> None:
        """Start them; with none everything is drawn here."""
        self._sheets = Sheets()
        self._processes = [p for p in (_started() for _ in range(count)) if p is not None]
        self._idle: SimpleQueue[subprocess.Popen[bytes]] = SimpleQueue()
        for process in self._processes:
            self._idle.put(process)
        self._threads = ThreadPoolExecutor(count) if self._processes else None

    def __enter__(self) -> Self:
        """Itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the processes, even in the middle of a picture."""
        for process in self._processes:
            process.kill()
        if self._threads is not None:
            self._threads.shutdown(cancel_futures=True)
        for process in self._processes:
            with suppress(OSError):  # what is left in the pipe has nowhere to go
                process.__exit__(None, None, None)

    @property
    def alone(self) -> bool:
        """Whether there is no process."""
        return not self._processes

    def ask(self, drawing: Drawing) -> Picture:
        """Have a picture drawn; processes take them in the order in which they are asked for."""
        threads = self._threads
        elsewhere = threads.submit(self._drawn, drawing) if threads is not None else None
        return Picture(drawing, self._sheets, elsewhere)

    def _drawn(self, drawing: Drawing) -> bytes:
        process = self._idle.get()
        try:
            assert process.stdin is not None
            assert process.stdout is not None
            pickle.dump(drawing, process.stdin, pickle.HIGHEST_PROTOCOL)
            process.stdin.flush()
            return bytes(pickle.load(process.stdout))
        finally:
            self._idle.put(process)


def crew_for(threads: int | None) -> Crew:
    """One that keeps within a number of threads, by default one per core."""
    return Crew(min((threads or os.cpu_count() or 1) - 1, MOST))


def finish(pictures: Sequence[Picture]) -> None:
    """Draw here what no process has begun, from the last on: they begin with the first."""
    for picture in reversed(pictures):
        picture.draw_unless_begun()


def _started() -> subprocess.Popen[bytes] | None:
    """A process that draws; None where none can be started."""
    if not sys.executable or getattr(sys, "frozen", False):  # embedded, or a program of one file
        return None
    apart: dict[str, Any] = {"start_new_session": True}
    if sys.platform == "win32":
        apart = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
    command = [sys.executable, "-c", _START, json.dumps(sys.path)]
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    try:
        return subprocess.Popen(command, **pipes, stderr=subprocess.DEVNULL, **apart)
    except (OSError, ValueError):
        return None
