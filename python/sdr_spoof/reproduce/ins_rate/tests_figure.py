"""Picture of the local test on one flight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.report.figures import style

from . import published

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from .tests_section import Local

FLIGHT = 0


def draw_local(found: Sequence[Local]) -> bytes:
    """Statistic of N1 and N2 on a turning flight, at both noises, with its threshold; PNG."""

    def draw(figure: Figure) -> None:
        for axes, noise in zip(figure.subplots(1, 2), (0.05, 0.005), strict=True):
            for case in found:
                if case.way != "turning" or case.noise_m_s != noise:
                    continue
                colour = {"n1": "#0072b2", "n2": "#e08214"}[case.grade]
                time_s = np.arange(case.dragged.shape[1]) + 1.0
                axes.plot(
                    time_s, case.dragged[FLIGHT], color=colour, label=case.grade.upper(), lw=0.9
                )
                axes.axhline(case.threshold_m_s, color=colour, ls="--", lw=0.9)
            axes.axvspan(*published.DRAG_S, color=style.ALARM, alpha=0.12, lw=0)
            axes.set(xlabel="time (s)", ylabel="size of the local mean (m/s)", ylim=(0, 0.17))
            axes.set_title(f"{noise:g} m/s a satellite")
        figure.axes[0].legend(loc="upper left", ncols=2)

    return style.png(draw, 9.6, 3.6)
