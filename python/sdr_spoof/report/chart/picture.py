"""Grids below each other, with one legend above them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from markupsafe import Markup

from . import marks, svg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .grid import Grid

WIDTH = 1000.0
"""Of a picture, in its own units; about pixels of the report's column."""
INK, MUTED = "#1d2733", "#5d6975"
SIZE = 12.5
"""Of type, in units of the picture."""
LINE = 18.0
"""From one line of a legend to the next."""
SAMPLE, GAP = 26.0, 20.0
"""A legend's sample of a line, and the room between two entries."""


@dataclass(frozen=True)
class Entry:
    """A colour's or dash's meaning."""

    name: str
    colour: str
    dash: marks.Dash = marks.SOLID
    width: float = 2.2
    shape: str = "line"
    """Or 'dot', 'ring', 'cross'."""


@dataclass(frozen=True)
class Drawing:
    """A finished picture."""

    content: str
    width: float
    height: float

    def svg(self, meaning: str) -> Markup:
        """The element for HTML; ``meaning`` is what the picture shows, in words."""
        return Markup(
            svg.element(
                "svg",
                self.content,
                viewBox=f"0 0 {self.width:g} {self.height:g}",
                role="img",
                aria_label=meaning,
                font_size=SIZE,
                fill=INK,
            )
        )


def drawing(*grids: Grid, legend: Sequence[Entry] = ()) -> Drawing:
    """Grids below each other; the legend above all."""
    left = max(grid.margins[0] for grid in grids)
    content, height = key(legend, left, WIDTH - left, 16.0)
    for grid in grids:
        more, used = grid.draw(WIDTH)
        content += svg.element("g", more, transform=f"translate(0 {height:g})")
        height += used
    return Drawing(content, WIDTH, height)


def key(
    entries: Sequence[Entry], left: float, room: float, first_y: float, size: float = SIZE
) -> tuple[str, float]:
    """A legend from a place on, wrapped where there is no more room; SVG and its height."""
    content, step = "", LINE * size / SIZE
    places = wrapped(entries, room, size)
    for entry, (x, line) in zip(entries, places, strict=True):
        content += _entry(entry, left + x, first_y + step * line, size)
    return content, step * (places[-1][1] + 1) + 4.0 if places else 0.0


def wrapped(entries: Sequence[Entry], room: float, size: float = SIZE) -> list[tuple[float, int]]:
    """Where each entry of a legend begins, and in which line."""
    x, line, places = 0.0, 0, []
    for entry in entries:
        length = SAMPLE + 6.0 + svg.width_of(entry.name, size) + GAP
        if x > 0.0 and x + length - GAP > room:
            x, line = 0.0, line + 1
        places.append((x, line))
        x += length
    return places


def _entry(entry: Entry, x: float, y: float, size: float) -> str:
    """Sample and name, on a baseline."""
    middle = y - 0.35 * size
    if entry.shape == "line":
        data = f"M{svg.FINE * x:.0f} {svg.FINE * middle:.0f}h{svg.FINE * SAMPLE:.0f}"
        pen = marks.stroke(entry.colour, entry.width, entry.dash)
        sample = fine(svg.element("path", d=data, **pen))
    else:
        sample = symbol(x + SAMPLE / 2, middle, entry.colour, entry.shape)
    return sample + svg.text(x + SAMPLE + 6.0, y, entry.name, font_size=size)


def symbol(x: float, y: float, colour: str, shape: str, radius: float = 4.0) -> str:
    """A dot, ring or cross."""
    if shape == "cross":
        data = f"M{x - 4:g} {y - 4:g}l8 8m0-8l-8 8"
        return svg.element("path", d=data, stroke=colour, stroke_width=1.6, fill="none")
    paint = {"fill": colour} if shape == "dot" else {"fill": "white", "stroke": colour}
    width = None if shape == "dot" else 1.8
    return svg.element("circle", cx=x, cy=y, r=radius, stroke_width=width, **paint)


def fine(content: str) -> str:
    """What is drawn in steps of 1 / FINE."""
    return svg.element("g", content, transform=f"scale({1 / svg.FINE:g})")
