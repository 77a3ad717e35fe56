"""Writes what a campaign says beside its results: tables as CSV, figures as PNG."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import analysis
from .trials import trials

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from .analysis import Rows
    from .table import Table
    from .trials import Trials


@dataclass(frozen=True)
class Analysis:
    """What was found, and the files that hold it."""

    detection: Rows
    coverage: Rows
    files: tuple[Path, ...]


def write_analysis(folder: Path, table: Table) -> Analysis:
    """Write ``detection``, ``latency``, ``roc`` and ``coverage`` as CSV and as figures.

    A figure that would be empty is left out, as is one of an earlier analysis.
    """
    every = trials(table)
    tables = {
        "detection": analysis.detection_table(table, every),
        "latency": analysis.latency_table(table, every),
        "roc": analysis.roc_table(table, every),
        "coverage": analysis.coverage_table(table, every),
    }
    files = []
    for name, rows in tables.items():
        files.append(folder / f"{name}.csv")
        analysis.write_csv(files[-1], rows)
    files += _figures(folder, table, every, tables)
    return Analysis(tables["detection"], tables["coverage"], tuple(files))


def _figures(folder: Path, table: Table, every: Trials, tables: dict[str, Rows]) -> list[Path]:
    from . import figures  # noqa: PLC0415 - matplotlib is slow to import

    title = str(table.spec["campaign"]["title"]) or "Campaign"
    on_air, drag = _latencies(table, every)
    names = ("detection", "roc", "coverage", "latency", "latency_drag")
    paths = {name: folder / f"{name}.png" for name in names}
    for path in paths.values():
        path.unlink(missing_ok=True)
    made = {
        "detection": figures.detection_figure(
            paths["detection"], tables["detection"], table.axes, title
        ),
        "roc": figures.roc_figure(paths["roc"], tables["roc"], table.axes, title),
        "coverage": figures.coverage_figure(paths["coverage"], tables["coverage"], title),
        "latency": figures.latency_figure(paths["latency"], on_air, title, "attack"),
        "latency_drag": figures.latency_figure(paths["latency_drag"], drag, title, "drag"),
    }
    return [paths[name] for name, drawn in made.items() if drawn]


_Latencies = dict[str, dict[str, "NDArray[np.float64]"]]


def _latencies(table: Table, every: Trials) -> tuple[_Latencies, _Latencies]:
    """Times from either start to the alarm, by attack and detector, NaN where not found."""
    attacked = every.where(every.hostile)
    names = analysis.attack_names(table, attacked)
    on_air: _Latencies = {}
    drag: _Latencies = {}
    for name in dict.fromkeys(names.tolist()):
        for detector in dict.fromkeys(attacked.detector.tolist()):
            mine = attacked.where((names == name) & (attacked.detector == detector))
            dragged = mine.where(~np.isnan(mine.drag_s))
            on_air.setdefault(name, {})[detector] = mine.on_air_latency_s
            drag.setdefault(name, {})[detector] = dragged.drag_latency_s
    return on_air, drag
