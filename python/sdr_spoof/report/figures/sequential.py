"""Statistics of sequential tests over time, with threshold and alarm."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.dme.judge import DME
from sdr_spoof.report.sequential_words import TITLES

from . import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from sdr_spoof.aiding.dme.judge import Judgement
    from sdr_spoof.aiding.dme.watch import Watched

QUIET = ("#0072b2", "#009e73", "#e08214", "#cc79a7", "#56b4e9", "#8c6bb1", "#7f7f7f", "#b8a000")
"""Channels that are not accused."""


def draw_sequential(judgement: Judgement, watched: tuple[Watched, ...]) -> bytes:
    """A panel a test: the rule's statistic of each channel; beside it its samples and their law."""
    tests = list(dict.fromkeys(w.test for w in watched))

    def draw(figure: Figure) -> None:
        grid = figure.subplots(max(len(tests), 1), 2, width_ratios=(3.0, 1.0), squeeze=False)
        for row, test in zip(grid, tests, strict=False):
            mine = [w for w in watched if w.test == test]
            for of, colour in zip(mine, cycle(QUIET), strict=False):
                accused = of.channel in judgement.spoofed or (judgement.captured and test == DME)
                row[0].plot(
                    *style.thinned(of.time_s, of.path),
                    lw=1.8 if accused else 1.0,
                    color=style.ALARM if accused else colour,
                    zorder=3 if accused else 2,
                    label=of.channel,
                )
            row[0].axhline(mine[0].threshold, color=style.INK, ls="--", lw=1.0)
            if judgement.alarm_s is not None:
                row[0].axvline(judgement.alarm_s, color=style.INK, ls=":", lw=0.9)
            row[0].set(ylabel="statistic", ylim=(0, 2.5 * mine[0].threshold))
            row[0].set_title(TITLES[test])
            row[0].legend(loc="upper left", ncols=8, fontsize=7, frameon=True, edgecolor="none")
            before_s = np.inf if judgement.alarm_s is None else judgement.alarm_s
            z = np.concatenate([of.z[of.time_s < before_s] for of in mine])
            x = np.linspace(-6.0, 6.0, 61)
            row[1].hist(np.clip(z, -6.0, 6.0), bins=x, density=True, color="#9ecae1")
            row[1].plot(x, np.exp(-0.5 * x**2) / np.sqrt(2.0 * np.pi), color=style.INK, lw=1.2)
            row[1].set(yscale="log", ylim=(1e-4, 1.0))
        grid[-1][0].set_xlabel("time (s)")
        grid[-1][1].set_xlabel("samples before an alarm, and law")

    return style.png(draw, 10.0, 0.6 + 2.4 * max(len(tests), 1))
