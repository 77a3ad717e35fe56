"""Figure of the detection study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import binomtest

from sdr_spoof.acquisition import AcquisitionConfig

from .acquisition import default_grid, theoretical_pd

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .acquisition import PdPoint


def draw(path: Path, points: Sequence[PdPoint]) -> None:
    """Draw measured and theoretical probability of detection into a PNG file."""
    figure = Figure(figsize=(8.0, 4.2), dpi=150, layout="constrained")
    axes = figure.subplots()
    pfa = AcquisitionConfig().pfa
    for signal, colour in (("B1I", "C0"), ("B1CP", "C3"), ("L1CA", "C2")):
        grid = default_grid(signal)
        mine = [p for p in points if p.signal == signal]
        fine = np.linspace(mine[0].cn0_dbhz - 1, mine[-1].cn0_dbhz + 1, 200)
        label = f"{signal}, {grid.blocks} x {1e3 * grid.period_s:g} ms, {grid.bins} Doppler bins"
        curve = theoretical_pd(grid, fine.tolist(), pfa)
        axes.plot(fine, curve, color=colour, label=f"{label}: theory")
        share = np.array([p.detected / p.trials for p in mine])
        ends = [binomtest(p.detected, p.trials).proportion_ci(0.95) for p in mine]
        error = [share - [e.low for e in ends], [e.high for e in ends] - share]
        axes.errorbar(
            [p.cn0_dbhz for p in mine],
            share,
            np.clip(error, 0, None),
            fmt="o",
            color=colour,
            markersize=4,
            capsize=2,
            label=f"{signal}: measured, 95 % interval",
        )
    axes.set_xlabel("C/N0 (dB-Hz)")
    axes.set_ylabel("probability of detection")
    axes.set_title(f"Detection in one search at a false-alarm probability of {pfa:g}")
    axes.set_ylim(-0.02, 1.02)
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", fontsize=8)
    figure.savefig(path)
