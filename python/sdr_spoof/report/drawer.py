"""A process of a :class:`~sdr_spoof.report.crew.Crew`: drawings come in, pictures go out."""

from __future__ import annotations

import pickle
import sys

from .figures import position, quiet, satellite, signals, sky_plot, spectrum  # noqa: F401  loaded before they are asked
from .figures.sheet import Sheets


def main() -> None:
    """Draw what comes until the pipe closes; a mistake ends the process."""
    asked, drawn = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr  # nothing else may get into the pipe
    sheets = Sheets()
    while True:
        try:
            drawing = pickle.load(asked)
        except EOFError:
            return
        pickle.dump(drawing.png(sheets), drawn)
        drawn.flush()
