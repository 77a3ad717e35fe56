"""Figure 11: share of false alarms against time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.report.figures import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

STEP = 50
LINES = (
    (("position", "n1"), "position, N1", "#0072b2", "-"),
    (("position", "n2"), "position, N2", "#0072b2", "--"),
    (("rate", "n1"), "rate, N1", "#e08214", "-"),
    (("rate", "n2"), "rate, N2", "#e08214", "--"),
    (("realigned", "n1"), "rate, N1, aligned each 250 s", "#009e73", "-"),
)


def draw_growth(hits: dict[tuple[str, str], NDArray[np.bool_]]) -> bytes:
    """Share of epochs beyond the threshold of either axis, in steps of 50 s; PNG."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for key, label, colour, dashes in LINES:
            either = np.asarray(hits[key].any(axis=2))
            share = 100 * either.reshape(len(either), -1, STEP).mean(axis=(0, 2))
            time_s = (np.arange(share.size) + 0.5) * STEP
            axes.plot(time_s, share, color=colour, ls=dashes, label=label)
        axes.set(
            xlabel="time since alignment (s)",
            ylabel="false alarms (%)",
            xlim=(0, share.size * STEP),
            ylim=(-2, 102),
        )
        axes.set_title("The rate form alarms earlier than the position form")
        axes.legend(loc="center right")

    return style.png(draw, 8.4, 4.0)
