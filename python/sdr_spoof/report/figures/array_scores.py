"""Scores of an array's satellites while the vehicle moves on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.aiding.array.verdict import SPOOFED

from . import style

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from sdr_spoof.aiding.array.examine import Finding

    Floats = NDArray[np.float64]


def draw_scores(findings: Sequence[Finding]) -> bytes:
    """One line a signal over the time of its tests, with the threshold; PNG.

    Below it the directions of arrival, where they were tested.
    """
    panels = [
        (
            "Does the source stand still while the vehicle moves?",
            "motion of the\ndirection (sigma)",
            [(f, f.time_s, f.score) for f in findings if f.score.size],
        ),
        (
            "Does it come from where the satellite is?",
            "off the satellite's\ndirection (sigma)",
            [(f, f.arrivals.time_s, f.arrivals.score) for f in findings if f.arrivals],
        ),
    ]
    shown = [p for p in panels if p[2]] or panels[:1]

    def draw(figure: Figure) -> None:
        grid = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (title, what, lines) in zip(grid, shown, strict=True):
            _draw_lines(axes, lines)
            axes.set_title(title)
            axes.set(ylabel=what)
        if shown[0][2]:
            grid[0].legend(loc="upper left")
        grid[-1].set(xlabel="time since the first sample (s)")

    return style.png(draw, 8.4, 0.9 + 3.0 * len(shown))


def _draw_lines(axes: Axes, lines: Sequence[tuple[Finding, Floats, Floats]]) -> None:
    for f, time_s, score in lines:
        spoofed = f.verdict == SPOOFED
        name = f"{f.satellite} {f.signal}"
        axes.plot(
            time_s,
            score,
            "o-" if spoofed else "-",
            ms=3,
            color=style.ALARM if spoofed else style.MUTED,
            label=name if spoofed else None,
            lw=1.4 if spoofed else 0.9,
        )
        if spoofed:
            axes.annotate(name, (time_s[-1], score[-1]), color=style.ALARM, ha="right", va="bottom")
    if lines:
        axes.axhline(lines[0][0].threshold, color=style.INK, ls="--", lw=1.0, label="threshold")
    if not all(f.verdict == SPOOFED for f, _, _ in lines):
        axes.plot([], [], color=style.MUTED, label="other satellites")
