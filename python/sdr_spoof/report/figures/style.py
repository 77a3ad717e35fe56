"""One look for all figures: colour-blind safe palette, readable type, PNG bytes out."""

from __future__ import annotations

import base64
import gc
import io
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray

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

Dash = tuple[int, tuple[int, ...]]
SOLID: Dash = (0, ())
DPI = 140
COLOURS, NO_DITHER = 256, Image.Dither.NONE
MOST_POINTS = 4000
"""Points of a line; a picture is 1400 pixels wide."""

RC: Mapping[str, object] = {
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # found by itself, each would be drawn twice
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


def sample(colour: str, dash: Dash = SOLID, width: float = 1.3) -> Line2D:
    """Line for a legend."""
    return Line2D([], [], color=colour, linewidth=width, linestyle=dash)


def png(
    draw: Callable[[Figure], None], width_in: float, height_in: float, *, placed: bool = False
) -> bytes:
    """Draws one figure and returns it as PNG; the same input gives the same bytes.

    ``placed``: ``draw`` says where axes and legends stand. Otherwise they are arranged so that
    nothing overlaps, for which everything is measured first.
    """
    with rc_context(RC), undisturbed():  # type: ignore[arg-type]
        return _png(draw, (width_in, height_in), None if placed else "constrained")


def _png(
    draw: Callable[[Figure], None],
    size_in: tuple[float, float],
    layout: Literal["constrained"] | None,
) -> bytes:
    figure = Figure(figsize=size_in, dpi=DPI, layout=layout)
    canvas = FigureCanvasAgg(figure)
    draw(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    return png_of(canvas)


def png_of(canvas: FigureCanvasAgg) -> bytes:
    """What a canvas shows, as PNG without a date.

    Of 256 colours, by an octree: no channel of a chart's few hues is off by more than 15 of 255,
    and those of few pixels; true colours take 2.6 times the room and twice the time.
    """
    buffer = io.BytesIO()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3]  # type: ignore[no-untyped-call]
    few = Image.fromarray(pixels).quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=NO_DITHER)
    few.putpalette([255 if value == 254 else value for value in few.getpalette() or ()])  # white
    few.save(buffer, "png", compress_level=1, dpi=(DPI, DPI))
    return buffer.getvalue()


@contextmanager
def undisturbed() -> Iterator[None]:
    """Draw without the collector of garbage, which would look through everything else meanwhile.

    Figures refer to themselves; afterwards they are collected, lest dozens of them pile up.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.collect(0)  # what was made meanwhile is the youngest there is
        if was_on:
            gc.enable()


def render(
    draw: Callable[[Figure], None], width_in: float, height_in: float, *, placed: bool = False
) -> str:
    """Draws one figure and returns it as a data URI, as :func:`png` does."""
    content = png(draw, width_in, height_in, placed=placed)
    return "data:image/png;base64," + base64.b64encode(content).decode("ascii")


def thinned(
    time_s: NDArray[np.float64], values: NDArray[np.float64], most: int = MOST_POINTS
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Fewer points whose line looks the same: the lowest and highest of equal runs of rows.

    A run in which a value is NaN keeps one, so that the line breaks there. Lines of no more than
    ``most`` points stay as they are.
    """
    if time_s.size <= most:
        return time_s, values
    run = -(-2 * time_s.size // most)
    starts = np.arange(0, time_s.size, run)
    runs = np.pad(values, (0, starts.size * run - time_s.size), "edge").reshape(-1, run)
    gaps = np.isnan(runs)
    lowest = np.where(gaps, np.inf, runs).argmin(axis=1)
    highest = np.where(gaps, -np.inf, runs).argmax(axis=1)
    gap = np.where(gaps.any(axis=1), gaps.argmax(axis=1), lowest)
    rows = np.unique(np.minimum(starts + np.array([lowest, highest, gap]), time_s.size - 1))
    return time_s[rows], values[rows]
