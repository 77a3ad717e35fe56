"""Panels side by side and below each other: limits, ticks, margins."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING

from . import marks, picture, svg
from .scale import Scale

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .panel import Panel

LINES, EDGE = "#e4e8ec", "#b8c0c8"
TITLE, NAME, SMALL = 13.5, 11.5, 11.0
"""Sizes of type: of titles, of the numbers at ticks, and of a panel's legend."""
TITLE_LINE, LEGEND_LINE = 16.0, picture.LINE * SMALL / picture.SIZE
BETWEEN = 14.0
"""Between rows that share their x axis."""
RIGHT = 14.0
TICK_EVERY_X, TICK_EVERY_Y = 62.0, 27.0
ROOM = 0.05
"""Left free around the data, of their reach."""


@dataclass(frozen=True)
class Grid:
    """Rows of panels, all of one number; empty places are None."""

    rows: Sequence[Sequence[Panel]]
    heights: Sequence[float]
    """Of the areas within the axes, row by row."""
    widths: Sequence[float] = ()
    """Of columns, against each other; equal if not told."""
    share_x: bool = False
    """Whether the panels of a column have one x axis, named at the lowest."""
    share_y: bool = False
    """Whether the panels of a row have one y axis, named at the leftmost."""
    caption: str = ""
    """Below, in the middle."""

    def draw(self, width: float) -> tuple[str, float]:
        """SVG of this width, and its height."""
        columns = len(self.rows[0])
        scales, margins = self._scales, self.margins
        share = self.widths or [1.0] * columns
        free = width - sum(margins) - RIGHT * columns
        wide = [free * s / sum(share) for s in share]
        left = [
            m + before
            for m, before in zip(
                margins,
                accumulate(
                    (a + b + RIGHT for a, b in zip(margins, wide, strict=True)), initial=0.0
                ),
                strict=False,
            )
        ]
        content, y = "", 0.0
        for r, row in enumerate(self.rows):
            y += self._head(row, wide, first=r == 0)
            for c, panel in enumerate(row):
                x_scale, y_scale = scales[r][c]
                frame = marks.Frame(wide[c], self.heights[r], x_scale, y_scale)
                frame = _equal(frame) if panel.equal else frame
                content += svg.element(
                    "g",
                    _draw(panel, frame, self._named(r, c), margins[c]),
                    transform=f"translate({round(left[c], 1):g} {round(y, 1):g})",
                )
            y += self.heights[r] + self._foot(r)
        if self.caption:
            y += 12.0
            content += svg.text(width / 2, y, self.caption, text_anchor="middle")
            y += 6.0
        return content, round(y, 1)

    @cached_property
    def margins(self) -> list[float]:
        """Room to the left of each column, for numbers and names of its y axes."""
        return [self._margin(c) for c in range(len(self.rows[0]))]

    @cached_property
    def _scales(self) -> list[list[tuple[Scale, Scale]]]:
        """Of x and y of every panel."""
        reach = [[(p.reach(0), p.reach(1)) for p in row] for row in self.rows]
        made = []
        for r, row in enumerate(self.rows):
            line = []
            for c, panel in enumerate(row):
                column = [reach[k][c][0] for k in range(len(self.rows))]
                xs = column if self.share_x else [reach[r][c][0]]
                ys = [of[1] for of in reach[r]] if self.share_y else [reach[r][c][1]]
                room = 0.0 if panel.x.low is not None else ROOM
                line.append((panel.x.scale(_union(xs), room), panel.y.scale(_union(ys), ROOM)))
            made.append(line)
        return made

    def _named(self, row: int, column: int) -> tuple[bool, bool]:
        """Whether the x and the y axis of a panel have numbers."""
        return not self.share_x or row == len(self.rows) - 1, not self.share_y or column == 0

    def _margin(self, column: int) -> float:
        if self.share_y and column > 0:
            return 4.0
        most = 20.0
        for r, row in enumerate(self.rows):
            axis = row[column].y
            ticks = axis.marked(self._scales[r][column][1], _most_ticks(self.heights[r]))
            numbers = max((svg.width_of(name, NAME) for _, name in ticks), default=0.0)
            lines = len(axis.label.splitlines())
            most = max(most, numbers + 16.0 + 15.5 * lines)
        return most

    def _head(self, row: Sequence[Panel], wide: Sequence[float], *, first: bool) -> float:
        """Room above a row, for titles and legends."""
        most = max(
            _legend_height(p, room) + TITLE_LINE * len(p.title.splitlines())
            for p, room in zip(row, wide, strict=True)
        )
        return max(most + (4.0 if most else 0.0), 8.0 if first else 0.0)

    def _foot(self, row: int) -> float:
        """Room below a row, for numbers and names of its x axes."""
        if self.share_x and row < len(self.rows) - 1:
            return BETWEEN
        turned = any(p.x.turned for p in self.rows[row])
        label = any(p.x.label for p in self.rows[row])
        return (44.0 if turned else 20.0) + (20.0 if label else 2.0)


def _most_ticks(height: float) -> int:
    """Of an upright axis: the middle and both sides of it at least."""
    return max(round(height / TICK_EVERY_Y), 3)


def _union(reaches: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return min(low for low, _ in reaches), max(high for _, high in reaches)


def _equal(frame: marks.Frame) -> marks.Frame:
    """Widen one of the scales, about its middle, until a unit is as long in both."""
    per_x = (frame.x.high - frame.x.low) / frame.width
    per_y = (frame.y.high - frame.y.low) / frame.height
    per = max(per_x, per_y)
    return replace(
        frame, x=_about(frame.x, per * frame.width), y=_about(frame.y, per * frame.height)
    )


def _about(scale: Scale, length: float) -> Scale:
    middle = 0.5 * (scale.low + scale.high)
    return replace(scale, low=middle - 0.5 * length, high=middle + 0.5 * length)


def _draw(panel: Panel, frame: marks.Frame, named: tuple[bool, bool], margin: float) -> str:
    x_ticks = panel.x.marked(frame.x, max(round(frame.width / TICK_EVERY_X), 1))
    y_ticks = panel.y.marked(frame.y, _most_ticks(frame.height))
    grid = _rules(frame, [v for v, _ in x_ticks], upright=True) if panel.x.grid else ""
    grid += _rules(frame, [v for v, _ in y_ticks], upright=False) if panel.y.grid else ""
    notes = [m for m in panel.drawn if isinstance(m, marks.Note)]
    below = "".join(m.draw(frame) for m in panel.below)
    lines = "".join(m.draw(frame) for m in panel.drawn if not isinstance(m, marks.Note))
    parts = [
        _clipped(frame, below + grid + lines),
        _edges(frame),
        _heading(panel, frame.width),
        _x_axis(panel, frame, x_ticks) if named[0] else "",
        _y_axis(panel, frame, y_ticks, margin) if named[1] else "",
        *(n.draw(frame) for n in notes),
    ]
    return "".join(parts)


def _clipped(frame: marks.Frame, content: str) -> str:
    """What is in the panel; nothing of it stands out."""
    size = f"0 0 {svg.FINE * frame.width:.0f} {svg.FINE * frame.height:.0f}"
    wide, high = round(frame.width, 1), round(frame.height, 1)
    return svg.element(
        "svg", content, width=wide, height=high, viewBox=size, stroke_linejoin="round"
    )


def _rules(frame: marks.Frame, values: Sequence[float], *, upright: bool) -> str:
    data = frame.across(values, upright=upright)
    return svg.element("path", d=data, **marks.stroke(LINES, 1.0)) if data else ""


def _edges(frame: marks.Frame) -> str:
    """The axes, on the left and below."""
    data = f"M0 0V{round(frame.height, 1):g}H{round(frame.width, 1):g}"
    return svg.element("path", d=data, fill="none", stroke=EDGE)


def _legend_height(panel: Panel, room: float) -> float:
    places = picture.wrapped(panel.entries, room, SMALL)
    return LEGEND_LINE * (places[-1][1] + 1) if places else 0.0


def _heading(panel: Panel, room: float) -> str:
    """Title, and the legend of the panel below it."""
    high = _legend_height(panel, room)
    legend, _ = picture.key(panel.entries, 0.0, room, LEGEND_LINE - 6.0 - high, SMALL)
    lines = panel.title.splitlines()
    weight = None if panel.light else "bold"
    size = SMALL if panel.light else TITLE
    first_y = -6.0 - high - TITLE_LINE * (len(lines) - 1)
    titles = (
        svg.text(0.0, first_y + TITLE_LINE * k, line, font_size=size, font_weight=weight)
        for k, line in enumerate(lines)
    )
    return "".join(titles) + legend


def _numbers(content: str, anchor: str) -> str:
    return svg.element("g", content, font_size=NAME, fill=picture.MUTED, text_anchor=anchor)


def _x_axis(panel: Panel, frame: marks.Frame, ticks: Sequence[tuple[float, str]]) -> str:
    content, y = "", frame.height + 15.0
    places = frame.width * frame.x.at([v for v, _ in ticks])
    for x, (_, name) in zip(places.tolist(), ticks, strict=True):
        if panel.x.turned:
            place = f"translate({x + 4:.1f} {frame.height + 6:g}) rotate(-90)"
            content += svg.text(0, 0, name, transform=place)
        else:
            content += svg.text(x, y, name)
    numbers = _numbers(content, "end" if panel.x.turned else "middle")
    deep = 62.0 if panel.x.turned else 33.0
    label = svg.text(frame.width / 2, frame.height + deep, panel.x.label, text_anchor="middle")
    return numbers + (label if panel.x.label else "")


def _y_axis(
    panel: Panel, frame: marks.Frame, ticks: Sequence[tuple[float, str]], margin: float
) -> str:
    content = ""
    places = frame.height * (1.0 - frame.y.at([v for v, _ in ticks]))
    for y, (_, name) in zip(places.tolist(), ticks, strict=True):
        content += svg.text(-6.0, y + 4.0, name)
    numbers = _numbers(content, "end")
    label = ""
    for k, line in enumerate(panel.y.label.splitlines()):
        place = f"translate({14.0 + 15.5 * k - margin:.1f} {frame.height / 2:.1f}) rotate(-90)"
        label += svg.text(0, 0, line, transform=place, text_anchor="middle")
    return numbers + label
