"""Figure of the comparison of the levels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from scipy.stats import norm

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .levels_compare import Comparison

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#882255")
SHOWN = {
    "coherent": ("phase_difference_glr",),
    "frequency-locked": ("code_difference", "code_minus_carrier"),
}
"""Latencies that are drawn: the attack, and the detectors that are made for it."""


def draw(path: Path, found: Sequence[Comparison]) -> None:
    """Differences against the law of no difference, and the times to the alarm."""
    with mpl.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        figure = Figure(figsize=(13, 4.5), layout="constrained")
        left, middle, right = figure.subplots(1, 3)
        _differences(left, found)
        _probabilities(middle, found)
        _latencies(right, found)
        figure.suptitle("What the detectors say at correlator level and at IF level")
        figure.savefig(path, dpi=120, metadata={"Software": None})


def _differences(axes: Any, found: Sequence[Comparison]) -> None:
    for name, colour in zip(("mean", "variance"), COLOURS, strict=False):
        deviates = np.sort([d for c in found if (d := getattr(c, name).deviate)])
        law = norm.ppf((np.arange(deviates.size) + 0.5) / max(deviates.size, 1))
        axes.plot(law, deviates, ".", color=colour, label=f"{name}s, {deviates.size} series")
    axes.plot([-3, 3], [-3, 3], color="0.5", linewidth=0.8)
    axes.set(xlabel="normal law", ylabel="difference, standard errors", title="Moments")
    axes.legend(frameon=False)


def _probabilities(axes: Any, found: Sequence[Comparison]) -> None:
    p = np.sort([c.p for c in found if min(c.values)])
    law = (np.arange(p.size) + 0.5) / max(p.size, 1)
    axes.loglog(law, p, ".", color=COLOURS[0])
    axes.plot(law, law, color="0.5", linewidth=0.8)
    axes.set(xlabel="uniform law", ylabel="p", title="Kolmogorov-Smirnov tests of the statistics")


def _latencies(axes: Any, found: Sequence[Comparison]) -> None:
    shown = [c for c in found if c.name[0] in SHOWN.get(c.attack, ()) and c.name[1] != "B1I"]
    names = dict.fromkeys(c.name[0] for c in shown)
    colours = dict(zip(names, COLOURS, strict=False))
    for c in shown:
        for latency_s, line in zip(c.latency_s, ("-", "--"), strict=True):
            times = np.sort(latency_s)
            share = (np.arange(times.size) + 1) / max(times.size, 1)
            alarmed = np.isfinite(times)
            axes.step(times[alarmed], share[alarmed], line, color=colours[c.name[0]], where="post")
    for name, colour in colours.items():
        axes.plot([], [], color=colour, label=name)
    axes.set(
        xlabel="from the drag's start to the alarm, s",
        ylabel="share of tracks",
        title="30, 38, 45 dB-Hz (dashed: correlator)",
    )
    axes.legend(frameon=False)
