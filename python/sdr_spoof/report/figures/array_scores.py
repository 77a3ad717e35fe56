"""Scores of an array's satellites while the vehicle moves on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.aiding.array.examine import SPOOFED

from . import style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from sdr_spoof.aiding.array.examine import Finding


def draw_scores(findings: Sequence[Finding]) -> bytes:
    """One line a signal over the time of its tests, with the threshold; PNG."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for f in findings:
            spoofed = f.verdict == SPOOFED
            name = f"{f.satellite} {f.signal}"
            axes.plot(
                f.time_s,
                f.score,
                "o-" if spoofed else "-",
                ms=3,
                color=style.ALARM if spoofed else style.MUTED,
                label=name if spoofed else None,
                lw=1.4 if spoofed else 0.9,
            )
            if spoofed:
                axes.annotate(
                    name, (f.time_s[-1], f.score[-1]), color=style.ALARM, ha="right", va="bottom"
                )
        limits = [f.threshold for f in findings if len(f.score)]
        if limits:
            axes.axhline(limits[0], color=style.INK, ls="--", lw=1.0, label="threshold")
        if not all(f.verdict == SPOOFED for f in findings):
            axes.plot([], [], color=style.MUTED, label="other satellites")
        axes.set(xlabel="time since the first sample (s)", ylabel="motion of the direction (sigma)")
        axes.set_title("Does the source stand still while the vehicle moves?")
        axes.legend(loc="upper left")

    return style.png(draw, 8.4, 4.2)
