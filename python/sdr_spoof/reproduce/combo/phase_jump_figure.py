"""Figure 2 of the publication, with axes in seconds, cycles and degrees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.report.figures import style

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def draw_jump(time_s: Floats, cycles: Floats, start_s: float, beat: Floats, small: Floats) -> bytes:
    """The measured difference with both capture models from ``start_s`` on; PNG."""
    after = time_s[time_s >= start_s]

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2, width_ratios=(3, 2))
        for axes in (left, right):
            axes.plot(time_s, cycles, color="#0072b2", label="measured")
            axes.plot(after, beat, color=style.INK, lw=1.0, label="phase of the sum (beat)")
            axes.plot(after, small, "--", color=style.ALARM, label="small angle, as published")
            axes.axvline(start_s, color=style.MUTED, lw=0.8, ls=":")
            axes.set(xlabel="time (s)", ylabel="scaled difference (cycles at B1C)")
        left.set_title("Jump, then slope")
        left.set_xlim(start_s - 1.0, time_s[-1])
        left.legend(loc="upper left")
        right.set_title("The jump")
        right.set(xlim=(start_s - 0.3, start_s + 0.6), ylim=(-0.1, 0.9))
        degrees = right.secondary_yaxis(
            "right", functions=(lambda c: 360.0 * c, lambda d: d / 360.0)
        )
        degrees.set_ylabel("degrees")

    return style.png(draw, 9.6, 3.8)
