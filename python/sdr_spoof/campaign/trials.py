"""The table of a campaign as trials: one satellite in one run, judged by one detector."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Self

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .table import Table

VERDICT = "verdict"
"""Stands for a detector: 'spoofed' is its alarm, at the first that decided it."""
ANY = "any"
"""Stands for all detectors: the first alarm of any of them, 'suspect' at least."""


@dataclass(frozen=True)
class Trials:
    """Columns of N trials; runs that failed are not among them."""

    point: NDArray[np.int64]
    run: NDArray[np.int64]
    satellite: NDArray[np.str_]
    detector: NDArray[np.str_]
    attack: NDArray[np.str_]
    """What happens to this satellite: kind of attack, or 'multipath', empty for nothing."""
    hostile: NDArray[np.bool_]
    """Whether that is an attack, and an alarm right."""
    start_s: NDArray[np.float64]
    """On the air from here, NaN for no attack."""
    drag_s: NDArray[np.float64]
    """Drag begins here, NaN for none."""
    alarmed: NDArray[np.bool_]
    alarm_s: NDArray[np.float64]
    score: NDArray[np.float64]
    """Largest statistic over its threshold, NaN where nothing could be tested."""

    def where(self, rows: NDArray[np.bool_]) -> Self:
        """Some of the trials."""
        return type(self)(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    @property
    def early(self) -> NDArray[np.bool_]:
        """Alarms before anything happened, which latch."""
        return np.asarray(self.alarmed & (self.alarm_s < self.start_s))

    @property
    def found(self) -> NDArray[np.bool_]:
        """Alarms that are not early."""
        return np.asarray(self.alarmed & ~self.early)

    @property
    def on_air_latency_s(self) -> NDArray[np.float64]:
        """From the attacker's first signal to the alarm; NaN where it was not found."""
        return np.where(self.found, self.alarm_s - self.start_s, np.nan)

    @property
    def drag_latency_s(self) -> NDArray[np.float64]:
        """From the start of the drag to the alarm, negative where the alarm came before it."""
        return np.where(self.found, self.alarm_s - self.drag_s, np.nan)


def trials(table: Table) -> Trials:
    """Every satellite of every run that did not fail, by every detector and by the verdict."""
    good = table.where(table["error"] == "")
    parts = [_of_detector(good, *name.split(".")[:2]) for name in _ending(good, "alarmed")]
    for satellite in (name.split(".")[0] for name in _ending(good, "verdict")):
        parts += [_of_any(good, satellite), _of_verdict(good, satellite)]
    names = [f.name for f in fields(Trials)]
    empty: dict[str, list[Any]] = {name: [np.zeros(0)] for name in names} if not parts else {}
    gathered = empty or {name: [part[name] for part in parts] for name in names}
    return Trials(**{name: np.concatenate(columns) for name, columns in gathered.items()})


def _of_detector(table: Table, satellite: str, detector: str) -> dict[str, NDArray[Any]]:
    def column(name: str) -> NDArray[Any]:
        return _numbers(table, f"{satellite}.{detector}.{name}")

    flag = table[f"{satellite}.{detector}.alarmed"]
    common = _common(table, satellite, detector)
    own = {"alarmed": flag == 1, "alarm_s": column("alarm_s"), "score": column("score")}
    return {name: values[flag >= 0] for name, values in (common | own).items()}


def _of_any(table: Table, satellite: str) -> dict[str, NDArray[Any]]:
    own = [name for name in _ending(table, "alarm_s") if name.startswith(f"{satellite}.")]
    first_s = np.nanmin([np.full(len(table), np.inf), *(table[name] for name in own)], axis=0)
    alarmed = np.isin(table[f"{satellite}.verdict"], ("suspect", "spoofed"))
    return _fused(table, satellite, ANY, alarmed, first_s)


def _of_verdict(table: Table, satellite: str) -> dict[str, NDArray[Any]]:
    alarm_s = _numbers(table, f"{satellite}.alarm_s")
    return _fused(table, satellite, VERDICT, table[f"{satellite}.verdict"] == "spoofed", alarm_s)


def _fused(
    table: Table,
    satellite: str,
    name: str,
    alarmed: NDArray[np.bool_],
    alarm_s: NDArray[np.float64],
) -> dict[str, NDArray[Any]]:
    common = _common(table, satellite, name)
    own = {"alarmed": alarmed, "alarm_s": alarm_s, "score": np.full(len(table), np.nan)}
    judged = table[f"{satellite}.verdict"] != ""
    return {name: values[judged] for name, values in (common | own).items()}


def _common(table: Table, satellite: str, detector: str) -> dict[str, NDArray[Any]]:
    return {
        "point": table["point"],
        "run": table["run"],
        "satellite": np.full(len(table), satellite),
        "detector": np.full(len(table), detector),
        "attack": table[f"{satellite}.attack"],
        "hostile": table[f"{satellite}.hostile"] == 1,
        "start_s": table[f"{satellite}.attack_start_s"],
        "drag_s": table[f"{satellite}.drag_start_s"],
    }


def _numbers(table: Table, name: str) -> NDArray[np.float64]:
    """A column, or NaN where it was not kept."""
    return table.columns.get(name, np.full(len(table), np.nan))


def _ending(table: Table, ending: str) -> list[str]:
    return [name for name in table.columns if name.endswith(f".{ending}")]
