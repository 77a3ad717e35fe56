"""Picture of the time to the alarm."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.report.figures import style

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from .drag_runs import Outcome

COLOURS = ("#0072b2", "#009e73", "#e08214", "#cc79a7", "#66727f")
LONGEST_S = 20


def draw_drags(found: Mapping[str, Sequence[Outcome]], drags_m_s: Sequence[float]) -> bytes:
    """Share of drags found within a time, a panel for N1 and one for N2; PNG."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, grade in zip(panels, ("n1", "n2"), strict=True):
            for number, (drag, colour) in enumerate(zip(drags_m_s, COLOURS, strict=True)):
                delay = np.concatenate([o.drag.delay_s[:, number].ravel() for o in found[grade]])
                time_s = np.arange(LONGEST_S + 1)
                share = [(delay <= s).mean() for s in time_s]
                axes.step(time_s, share, where="post", color=colour, label=f"{drag:g} m/s")
            axes.set(
                xlabel="time since the drag began (s)", xlim=(0, LONGEST_S), ylim=(-0.02, 1.04)
            )
            axes.set_title(grade.upper())
        panels[0].set_ylabel("share found")
        panels[1].legend(loc="lower right", title="drag")

    return style.png(draw, 9.6, 3.6)
