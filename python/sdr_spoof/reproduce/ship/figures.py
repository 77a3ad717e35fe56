"""Figures of the ship's study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.report.figures import style

from .simulation import ATTACK_S, voyage

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .attack_runs import Outcome

    Floats = NDArray[np.float64]

COLOURS = ("#0072b2", "#e08214", "#009e73", "#cc79a7", "#56b4e9", "#d55e00")
LEAST_M = 0.3
TICKS_S = (0, 1, 2, 5, 10, 20, 50, 100, 200, 400)


def _times(axes: Axes) -> None:
    axes.axvspan(*ATTACK_S, color="#f3e3e0", zorder=0, lw=0)
    axes.set(xlabel="time (s)", xlim=(400, 1500))


def draw_literal(drawn: Mapping[str, Floats]) -> bytes:
    """Median error against time, a colour a drag; dashed without exclusion."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        time_s = voyage().time_s
        speeds = list(dict.fromkeys(name.split()[0] for name in drawn))
        for name, error in drawn.items():
            speed, how = name.split()
            if how == "self-normalised":
                continue
            line = "--" if how == "off" else "-"
            label = f"{speed} m/s" if how != "off" else None
            colour = COLOURS[speeds.index(speed)]
            axes.plot(time_s, np.maximum(error, LEAST_M), line, color=colour, label=label)
        axes.plot([], [], "--", color=style.MUTED, label="no exclusion")
        _times(axes)
        axes.set(yscale="log", ylabel="horizontal error (m)")
        axes.legend(ncols=2)

    return style.png(draw, 9.6, 3.8)


def draw_errors(found: Sequence[Outcome]) -> bytes:
    """Median errors with the robust exclusion, all channels left, some right."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, 2, sharey=True)
        time_s = voyage().time_s
        for axes, three in zip(panels, (False, True), strict=True):
            some = [o for o in found if ("three" in o.named.name) == three and not o.named.floor]
            for colour, outcome in zip(COLOURS, some, strict=False):
                error = np.maximum(outcome.median_m, LEAST_M)
                axes.plot(time_s, error, color=colour, label=outcome.named.title)
            _times(axes)
            axes.set(yscale="log")
            axes.set_title("b) three satellites" if three else "a) all satellites")
            if some:
                axes.legend(fontsize=8)
        panels[0].set_ylabel("horizontal error (m)")

    return style.png(draw, 9.6, 4.0)


def draw_delays(found: Sequence[Outcome]) -> bytes:
    """Delay of every run, an attack a row."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for row, outcome in enumerate(found):
            seen = outcome.delay_s[np.isfinite(outcome.delay_s)]
            axes.plot(seen, np.full(seen.size, row), "o", ms=4, alpha=0.35, color=COLOURS[0], mew=0)
            if seen.size:
                axes.plot(np.median(seen), row, "|", ms=14, mew=2, color=style.ALARM)
        axes.set_yticks(range(len(found)), [o.named.title for o in found])
        axes.invert_yaxis()
        axes.set_xscale("symlog", linthresh=5)
        axes.set_xticks(TICKS_S, [f"{t:g}" for t in TICKS_S])
        axes.set(xlim=(-0.5, 450), xlabel="delay of the alarm (s); red: median of those found")

    return style.png(draw, 9.6, 0.9 + 0.3 * len(found))
