"""Figures 5, 6, 7, 9 and 10: statistics of one flight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.report.figures import style

from . import published

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

NAMES = ("east", "north", "up")
COLOURS = ("#0072b2", "#e08214", "#009e73")
ATTACKS = ((published.HOVER_S, "hover"), (published.DRAG_S, "drag"), (published.STEP_S, "step"))


def draw_rates(gnss: Floats, ins: Floats) -> bytes:
    """Velocities (E, 3) by phase and by the INS, one panel each; PNG."""

    def draw(figure: Figure) -> None:
        for number, axes in enumerate(figure.subplots(1, 3)):
            axes.plot(gnss[:, number], color=style.INK, lw=2.0, label="carrier phase")
            axes.plot(ins[:, number], color=COLOURS[1], lw=0.9, ls="--", label="INS")
            axes.set(xlabel="time (s)", title=NAMES[number])
        figure.axes[2].set_ylim(-1.0, 1.0)
        figure.axes[0].set_ylabel("velocity (m/s)")
        figure.axes[0].legend(loc="lower left")

    return style.png(draw, 10.0, 3.2)


def draw_clean(values: Floats, thresholds: Sequence[float], unit: str) -> bytes:
    """Statistic (E, 3) with the printed thresholds; PNG."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for number, (name, colour) in enumerate(zip(NAMES, COLOURS, strict=True)):
            axes.plot(values[:, number], color=colour, label=name)
        for threshold, colour in zip(thresholds, COLOURS, strict=False):
            for sign in (-1, 1):
                axes.axhline(sign * threshold, color=colour, ls="--", lw=0.9)
        axes.set(xlabel="time since alignment (s)", ylabel=f"GNSS minus INS ({unit})")
        axes.legend(loc="upper left", ncols=3)

    return style.png(draw, 8.4, 3.6)


def draw_attacked(values: Sequence[Floats], unit: str) -> bytes:
    """Clean and the three attacked statistics (E, 3), around each attack; PNG."""
    thresholds = published.RATE_M_S if unit == "m/s" else published.POSITION_M

    def draw(figure: Figure) -> None:
        panels = figure.subplots(2, 3)
        for column, ((start, stop), name) in enumerate(ATTACKS):
            rows = slice(max(0, int(start) - 25), int(stop) + 50)
            time_s = np.arange(rows.start, rows.stop)
            for row in range(2):
                axes = panels[row][column]
                axes.plot(time_s, values[0][rows, row], color="#9aa5b1", lw=2.0)
                axes.plot(time_s, values[column + 1][rows, row], color=COLOURS[row], lw=1.1)
                axes.axvspan(start, stop, color=style.ALARM, alpha=0.1, lw=0)
                for sign in (-1, 1):
                    axes.axhline(sign * thresholds[row], color=style.INK, ls="--", lw=0.8)
                axes.set_title(f"{name}, {NAMES[row]}")
                if name == "drag" and unit == "m/s":
                    clean = values[0][rows, row]
                    axes.set_ylim(min(clean.min(), 0) - 0.3, max(clean.max(), 0) + 0.3)
        for axes in panels[:, 0]:
            axes.set_ylabel(f"GNSS minus INS ({unit})")
        for axes in panels[1]:
            axes.set_xlabel("time (s)")

    return style.png(draw, 10.0, 5.2)
