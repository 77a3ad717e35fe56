"""One look for all figures: a colour-blind safe palette, and PNG where a chart is not enough.

The report draws charts (:mod:`sdr_spoof.report.chart`); studies and campaigns take Matplotlib.
"""

from __future__ import annotations

import base64
import gc
import io
from typing import TYPE_CHECKING

from sdr_spoof.report.chart.thin import MOST_POINTS, thinned

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from matplotlib.figure import Figure

__all__ = ["MOST_POINTS", "colour", "png", "render", "thinned"]

INK = "#1d2733"
MUTED = "#66727f"
GRID = "#e4e8ec"
ALARM = "#c0392b"
TRUTH = "#111111"
VERDICTS = {"spoofed": ALARM, "suspect": "#c98a00"}
"""Of satellites that are not clean."""
BAND_COLOURS = {
    "B1I": "#0072b2",
    "B1CP": "#e08214",
    "B1CD": "#cc79a7",
    "L1CA": "#009e73",
    "E5AQ": "#56b4e9",
    "E5BQ": "#d55e00",
}
"""Okabe-Ito hues; a signal keeps its colour in every figure."""

RC: Mapping[str, object] = {
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.labelcolor": INK,
    "axes.edgecolor": "#b8c0c8",
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "lines.linewidth": 1.3,
    "text.color": INK,
    "figure.facecolor": "white",
    "path.simplify": True,
}


def colour(signal: str) -> str:
    """Colour of a signal; grey for one without an own colour."""
    return BAND_COLOURS.get(signal, MUTED)


def png(draw: Callable[[Figure], None], width_in: float, height_in: float) -> bytes:
    """Draws one figure and returns it as PNG; the same input gives the same bytes."""
    from matplotlib import rc_context  # noqa: PLC0415 - slow to import, and not for the report
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    with rc_context(RC):  # type: ignore[arg-type]
        figure = Figure(figsize=(width_in, height_in), dpi=140, layout="constrained")
        FigureCanvasAgg(figure)
        draw(figure)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", metadata={"Software": None})
    del figure
    gc.collect(1)  # figures refer to themselves; left to themselves, dozens of them pile up
    return buffer.getvalue()


def render(draw: Callable[[Figure], None], width_in: float, height_in: float) -> str:
    """Draws one figure and returns it as a data URI; the same input gives the same bytes."""
    content = png(draw, width_in, height_in)
    return "data:image/png;base64," + base64.b64encode(content).decode("ascii")
