"""Signals that are not to be trusted for some time: each is tracked, but apart from its pair."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .errors import ConfigError
from .signals import signal_spec

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from . import _core

    Loops = _core.Tracker | _core.Simulator


@dataclass(frozen=True)
class Isolation:
    """A signal that is taken to be captured by a spoofer for some time.

    Its pair is parted: the other sideband goes on by itself, and so does this one, its rows marked
    :attr:`State.CAPTURED`.
    """

    signal: str
    prn: int
    from_s: float
    """Seconds since the first sample of the recording."""
    until_s: float = math.inf
    """From here on all signals of the satellite are trusted, and may be joined, again."""

    def begin(self, loops: Loops) -> None:
        """Mark the signal.

        Raises:
            ConfigError: it is not tracked.
        """
        try:
            loops.isolate(signal_spec(self.signal).system, self.prn, self.signal)
        except ValueError as error:
            raise ConfigError(str(error)) from error

    def end(self, loops: Loops) -> None:
        """Take the marks of the satellite away."""
        loops.rejoin(signal_spec(self.signal).system, self.prn)


def isolation_marks(
    isolations: Sequence[Isolation], sample_rate_hz: float
) -> list[tuple[int, Callable[[Loops], None]]]:
    """What begins or ends isolations, and at which samples, on whole bytes and in order."""
    marks = [
        (math.ceil(time_s * sample_rate_hz / 8) * 8, mark)
        for i in isolations
        for time_s, mark in ((i.from_s, i.begin), (i.until_s, i.end))
        if math.isfinite(time_s)
    ]
    return sorted(marks, key=lambda mark: mark[0])
