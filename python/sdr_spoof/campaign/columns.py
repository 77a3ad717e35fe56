"""Columns of the results: known from the campaign's points before any run.

Names are ``<satellite>.<what>``, ``<satellite>.<signal>.<what>`` and
``<satellite>.<detector>.<what>``, such as ``C27.B1CP.held_until_s``. A column that does not apply
to a point (a satellite that is not in its scenario) is empty there: NaN, -1 or the empty text.
"""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Literal

from sdr_spoof.errors import ConfigError

from .levels import subjects

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from .points import Point

Kind = Literal["number", "flag", "text"]
Value = float | bool | str | None

OF_SATELLITE: dict[str, Kind] = {
    "verdict": "text",
    "alarm_s": "number",
    "onset_s": "number",
    "band": "text",
    "confidence": "number",
    "attack": "text",
    "hostile": "flag",
    "attack_start_s": "number",
    "capture_s": "number",
    "drag_start_s": "number",
}
"""The fused verdict, with the first alarm that decides it; then the truth: kind of attack (empty:
none), whether it is one or multipath, on the air from, power passed at, drag."""

TRUTH = frozenset({"attack", "hostile", "attack_start_s", "capture_s", "drag_start_s"})
"""Kept whatever is asked for: nothing can be said of the rest without it."""

OF_SIGNAL: dict[str, Kind] = {"held_until_s": "number", "cn0_dbhz": "number"}
"""Last epoch of synchronised tracking, and the mean C/N0 of such epochs."""

OF_DETECTOR: dict[str, Kind] = {
    "alarmed": "flag",
    "alarm_s": "number",
    "onset_s": "number",
    "band": "text",
    "score": "number",
    "tested_s": "number",
}
"""``score`` is the largest statistic of the run over its threshold: above 1 is an alarm."""


@dataclass(frozen=True)
class Column:
    """One column of the results."""

    name: str
    kind: Kind


def columns_of(point: Point) -> Iterator[Column]:
    """What a run at a point yields."""
    for name, signals in subjects(point.scenario).items():
        yield from _prefixed(name, OF_SATELLITE)
        for signal in signals:
            yield from _prefixed(f"{name}.{signal}", OF_SIGNAL)
        for detector in point.detection.detectors:
            yield from _prefixed(f"{name}.{detector}", OF_DETECTOR)


def columns(
    points: Sequence[Point], patterns: Sequence[str] = ("*",), path: Path | str = "campaign"
) -> list[Column]:
    """Columns of a campaign: the truth, and those of all its points that match a pattern.

    Raises:
        ConfigError: a pattern matches none.
    """
    every = list(dict.fromkeys(c for point in points for c in columns_of(point)))
    for pattern in patterns:
        if not any(fnmatchcase(c.name, pattern) for c in every):
            some = ", ".join(c.name for c in every[:4])
            raise ConfigError(
                f"{path}: [output] columns: '{pattern}' matches no column; such are {some}"
            )
    return [c for c in every if _is_kept(c.name, patterns)]


def _is_kept(name: str, patterns: Sequence[str]) -> bool:
    is_truth = name.rpartition(".")[2] in TRUTH
    return is_truth or any(fnmatchcase(name, pattern) for pattern in patterns)


def _prefixed(prefix: str, kinds: dict[str, Kind]) -> Iterator[Column]:
    return (Column(f"{prefix}.{name}", kind) for name, kind in kinds.items())
