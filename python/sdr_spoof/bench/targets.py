"""What is to be reached at 120 Msps, against what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from . import Measurement

_AT_HZ = 120e6


class Quantity(Enum):
    """What a target is a bound of; the value is its unit."""

    TIMES_REAL_TIME = "x"
    SECONDS = "s"
    CHANNEL_COST = "µs per ms"
    MEMORY = "MB"

    def of(self, m: Measurement) -> tuple[float, float, float]:
        """Median, lowest and highest value measured."""
        seconds = (m.median_s, m.lowest_s, m.highest_s)
        match self:
            case Quantity.TIMES_REAL_TIME:
                middle, low, high = (m.signal_s / s for s in (m.median_s, m.highest_s, m.lowest_s))
                return middle, low, high
            case Quantity.SECONDS:
                return seconds
            case Quantity.CHANNEL_COST:
                middle, low, high = (1e3 * s / m.signal_s for s in seconds)
                return middle, low, high
            case Quantity.MEMORY:
                return (m.peak_memory_mb,) * 3

    def met(self, value: float, wanted: float) -> bool:
        """Whether a value is as good as wanted."""
        return value >= wanted if self is Quantity.TIMES_REAL_TIME else value <= wanted


@dataclass(frozen=True)
class Target:
    """A figure to reach."""

    name: str
    stage: str
    workload: str
    quantity: Quantity
    wanted: dict[int, float]
    """By number of threads."""
    portable: bool = False
    """Without vector instructions beyond those that every processor has."""

    def found(self, measurements: Sequence[Measurement], threads: int) -> Measurement | None:
        """What was measured for it."""
        key = (self.stage, self.workload, _AT_HZ, threads, self.portable)
        for m in measurements:
            portable = m.level == "portable"
            if (m.stage, m.workload, m.sample_rate_hz, m.threads, portable) == key:
                return m
        return None


_TIMES, _SECONDS = Quantity.TIMES_REAL_TIME, Quantity.SECONDS
_COST, _MEMORY = Quantity.CHANNEL_COST, Quantity.MEMORY
TARGETS = (
    Target("W1, whole receiver", "receiver", "W1", _TIMES, {1: 6, 2: 11}),
    Target("W2, whole receiver", "receiver", "W2", _TIMES, {1: 4.5, 2: 8}),
    Target("W1, correlator engine alone", "engine", "W1", _TIMES, {1: 10, 2: 18}),
    Target("W1, whole receiver, portable", "receiver", "W1", _TIMES, {1: 2, 2: 4}, portable=True),
    Target("synthesis, 24 emitters and noise", "synthesis", "24 emitters", _TIMES, {1: 1, 2: 2}),
    Target("blind acquisition, B1I", "acquisition", "B1I", _SECONDS, {1: 1, 2: 1}),
    Target("blind acquisition, B1C", "acquisition", "B1C", _SECONDS, {1: 3, 2: 3}),
    Target("cost of the 25th channel (B1I)", "channel", "B1I", _COST, {1: 2}),
    Target("memory, W1, whole receiver", "receiver", "W1", _MEMORY, {1: 400, 2: 400}),
    Target("memory, W2, whole receiver", "receiver", "W2", _MEMORY, {1: 400, 2: 400}),
)


def markdown_targets(measurements: Sequence[Measurement]) -> str:
    """The table of targets for docs/validation.md, with medians (lowest to highest)."""
    lines = [
        "| at 120 Msps | target, 1 thread | measured | target, 2 threads | measured |",
        "|---|---|---|---|---|",
    ]
    for target in TARGETS:
        cells = [target.name]
        for threads in (1, 2):
            cells += _cells(target, measurements, threads)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _cells(target: Target, measurements: Sequence[Measurement], threads: int) -> list[str]:
    if threads not in target.wanted:
        return ["", ""]
    quantity, wanted = target.quantity, target.wanted[threads]
    sign = "≥" if quantity is Quantity.TIMES_REAL_TIME else "≤"
    bound = f"{sign} {wanted:g} {quantity.value}"
    found = target.found(measurements, threads)
    if found is None:
        return [bound, "not measured"]
    middle, low, high = quantity.of(found)
    spread = "" if low == high else f" ({low:.3g} to {high:.3g})"
    missed = "" if quantity.met(middle, wanted) else ", missed"
    return [bound, f"{middle:.3g} {quantity.value}{spread}{missed}"]
