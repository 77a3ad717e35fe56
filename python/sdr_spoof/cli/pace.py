"""How fast something goes and how long it will still take."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

_OVER = 200
"""Steps that the rate is taken over."""


class Pace:
    """Rate over the last steps; what was done before the first does not count for it."""

    def __init__(self, unit: str, clock: Callable[[], float] = time.monotonic) -> None:
        """Counts in a unit, such as runs."""
        self._unit = unit
        self._clock = clock
        self._steps: deque[tuple[float, float]] = deque(maxlen=_OVER)
        self._done = self._total = 0.0

    def note(self, done: float, total: float) -> None:
        """Note that so many of all are done now."""
        self._done, self._total = done, total
        self._steps.append((self._clock(), done))

    @property
    def rate(self) -> float:
        """Per second; 0 while unknown."""
        if len(self._steps) < 2:
            return 0.0
        (begin, first), (end, last) = self._steps[0], self._steps[-1]
        return (last - first) / (end - begin) if end > begin else 0.0

    def __str__(self) -> str:
        """``120 of 400 runs, 12.3 runs/s, 0:00:23 left``."""
        counts = f"{self._done:.0f} of {self._total:.0f} {self._unit}"
        if not self.rate or self._done >= self._total:
            return counts
        left = round((self._total - self._done) / self.rate)
        clock = f"{left // 3600}:{left // 60 % 60:02d}:{left % 60:02d}"
        return f"{counts}, {self.rate:.3g} {self._unit}/s, {clock} left"
