"""Figure of the jitter study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .tracking import Jitter

PANELS = (
    ("cycle", "Carrier loops", ("B1I phase", "B1CP phase", "combo main", "combo subcarrier")),
    ("chip", "Code loops", ("B1I code", "B1CP code")),
)
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


def draw(path: Path, rows: Sequence[Jitter]) -> None:
    """Measured jitter (marks) on the thermal-noise formulas (lines), one panel a kind of loop."""
    with mpl.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        figure = Figure(figsize=(9, 4), layout="constrained")
        for axes, (unit, title, loops) in zip(figure.subplots(1, 2), PANELS, strict=True):
            for loop, colour in zip(loops, COLOURS, strict=False):
                points = [r for r in rows if r.loop == loop]
                cn0 = np.array([r.cn0_dbhz for r in points])
                axes.semilogy(cn0, [r.expected for r in points], color=colour)
                axes.errorbar(
                    cn0,
                    [r.measured for r in points],
                    yerr=[2 * r.standard_error * r.measured for r in points],
                    fmt="o",
                    color=colour,
                    label=f"{loop}, {points[0].bandwidth_hz:g} Hz",
                )
            axes.set(title=title, xlabel="C/N0, dB-Hz", ylabel=f"jitter, {unit} (1 sigma)")
            axes.legend(frameon=False)
        figure.suptitle("Lines: thermal-noise formulas; marks: measured, 2 standard errors")
        figure.savefig(path, dpi=120, metadata={"Software": None})
