"""Figure 3 of the publication: detection probability along both sweeps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.detectors import combo_model as model
from sdr_spoof.report.figures import style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from sdr_spoof.reproduce.study import Table

    from .thresholds import Law, Sweep

COLOURS = ("#0072b2", "#e08214")
LABELS = ("C/N0 = 30 as a ratio, threshold {:.3f} Hz", "30 dB-Hz, threshold {:.3f} Hz")


def draw_sweeps(sweeps: Sequence[Sweep], laws: Sequence[Law], tables: Sequence[Table]) -> bytes:
    """Lines of equation 26 with the draws of each point, a panel a sweep; PNG."""

    def draw(figure: Figure) -> None:
        for axes, sweep, table in zip(figure.subplots(1, 2), sweeps, tables, strict=True):
            fine = np.linspace(sweep.swept[0], sweep.swept[-1], 200)
            shift = np.interp(fine, sweep.swept, sweep.shift_hz)
            for number, (of, colour) in enumerate(zip(laws, COLOURS, strict=True)):
                pd = model.detection_probability(shift, of.sigma_hz, of.threshold_hz)
                label = LABELS[number].format(of.threshold_hz)
                axes.plot(fine, pd, color=colour, label=label)
                drawn, low, high = (
                    np.array([row[4 + 5 * number + k] for row in table.rows], dtype=float)
                    for k in range(3)
                )
                bars = np.maximum([drawn - low, high - drawn], 0.0)
                axes.errorbar(sweep.swept, drawn, yerr=bars, fmt="o", ms=4, color=colour)
            axes.set(xlabel=sweep.label, ylabel="detection probability", ylim=(0.55, 1.02))
        first, second = figure.axes
        first.set_title("a) eta 1.5")
        second.set_title("b) f_e 10 Hz")
        first.legend(loc="lower right")

    return style.png(draw, 9.6, 3.8)
