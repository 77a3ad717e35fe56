"""Figure of the frame errors of B-CNAV1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from .bcnav1 import LENGTHS, PEER, SYMBOL_S, best_rate

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

    from .bcnav1 import Point

COLOURS = {"subframe 2": "#0072B2", "subframe 3": "#D55E00"}
OFFSET_DB = -10 * np.log10(SYMBOL_S)
LOWEST = 2e-4


def draw(path: Path, points: Sequence[Point]) -> None:
    """Error rates of both subframes (marks), the best possible (lines), the peer's (crosses)."""
    with mpl.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        figure = Figure(figsize=(7.5, 4.5), layout="constrained")
        axes = figure.subplots()
        for name, colour in COLOURS.items():
            _draw_part(axes, points, name, colour)
        data = np.array([p.data_cn0_dbhz for p in points])
        first = np.array([p.start_rate for p in points])
        axes.semilogy(data[first > 0], first[first > 0], "s:", color="#777777", markersize=4,
                      label="start of a frame, from one subframe 1")  # fmt: skip
        axes.set(xlabel="C/N0 of the data component, dB-Hz", ylabel="error rate")
        axes.set_ylim(LOWEST, 1.2)
        share = points[0].signal_cn0_dbhz - points[0].data_cn0_dbhz
        moves = (lambda x: np.add(x, share), lambda x: np.subtract(x, share))
        second = axes.secondary_xaxis("top", functions=moves)
        second.set_xlabel("C/N0 of the whole signal, dB-Hz")
        axes.legend(frameon=False, fontsize=8)
        figure.savefig(path, dpi=120, metadata={"Software": None})


def _draw_part(axes: Axes, points: Sequence[Point], name: str, colour: str) -> None:
    field = name.replace(" ", "") + "_rate"
    rate = np.array([getattr(p, field) for p in points])
    data = np.array([p.data_cn0_dbhz for p in points])
    error = 2 * np.sqrt(rate * (1 - rate) / points[0].frames)
    seen = rate > 0
    lower = np.minimum(error, rate * 0.9)
    axes.errorbar(
        data[seen], rate[seen], yerr=(lower[seen], error[seen]), fmt="o-", color=colour,
        markersize=4, label=f"{name}, 2 standard errors",
    )  # fmt: skip
    grid = np.linspace(data[0], data[-1], 100)
    best = [best_rate(float(x - OFFSET_DB), *LENGTHS[name]) for x in grid]
    axes.semilogy(grid, best, "--", color=colour, label=f"{name}, best possible code")
    others = [(p.es_n0_db + OFFSET_DB, getattr(p, field)) for p in PEER if getattr(p, field)]
    if others:
        axes.semilogy(*zip(*others, strict=True), "x-", color=colour, alpha=0.6,
                      label=f"{name}, Pocket SDR")  # fmt: skip
