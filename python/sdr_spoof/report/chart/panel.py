"""A panel: axes, and what is drawn in them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import marks
from . import scale as scales

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .picture import Entry


@dataclass
class Axis:
    """One axis of a panel; what is None is found from the data."""

    label: str = ""
    low: float | None = None
    high: float | None = None
    ticks: Sequence[float] | None = None
    names: Sequence[str] | None = None
    symlog: scales.Symlog | None = None
    grid: bool = True
    turned: bool = False
    """Whether its names are written upwards."""

    def scale(self, reach: tuple[float, float], share: float) -> scales.Scale:
        """Scale that shows the data of this reach, with some room."""
        low, high = scales.stretch(*reach, share)
        low = self.low if self.low is not None else low
        high = self.high if self.high is not None else high
        if high <= low:
            high = low + 1.0
        return scales.Scale(low, high, self.symlog)

    def marked(self, of: scales.Scale, most: int) -> list[tuple[float, str]]:
        """Ticks within the scale, and their names."""
        values = self.ticks if self.ticks is not None else scales.ticks(of.low, of.high, most)
        named = self.names if self.names is not None else scales.names(values)
        room = 1e-9 * (of.high - of.low)
        return [
            (v, n)
            for v, n in zip(values, named, strict=True)
            if of.low - room <= v <= of.high + room
        ]


@dataclass
class Panel:
    """Gathers what is to be drawn; coordinates are those of the data."""

    title: str = ""
    x: Axis = field(default_factory=Axis)
    y: Axis = field(default_factory=Axis)
    entries: list[Entry] = field(default_factory=list)
    """Legend above the panel."""
    equal: bool = False
    """Whether a unit of x is as long as one of y."""
    light: bool = False
    """Whether its title is small."""
    below: list[marks.Mark] = field(default_factory=list)
    """Shaded, below the grid's lines and all others."""
    drawn: list[marks.Mark] = field(default_factory=list)

    def line(
        self,
        x: NDArray[np.float64],
        y: NDArray[np.float64],
        colour: str,
        width: float = 1.6,
        dash: marks.Dash = marks.SOLID,
        opacity: float | None = None,
    ) -> None:
        """A line, thinned to what the picture can show."""
        self.drawn.append(marks.Line(x, y, colour, width, dash, opacity))

    def dots(
        self, x: ArrayLike, y: ArrayLike, colour: str, size: float = 5.0, shape: str = "dot"
    ) -> None:
        """A 'dot' or 'cross' at each point."""
        at_x, at_y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        self.drawn.append(marks.Dots(at_x, at_y, colour, size, shape))

    def area(
        self,
        x: NDArray[np.float64],
        low: NDArray[np.float64],
        high: NDArray[np.float64],
        colour: str,
        opacity: float,
    ) -> None:
        """Shade between two lines."""
        self.below.append(marks.Area(x, low, high, colour, opacity))

    def bar(
        self,
        x: tuple[float, float],
        y: tuple[float, float],
        colour: str,
        opacity: float | None = None,
    ) -> None:
        """A rectangle that must be seen whole."""
        self.drawn.append(marks.Block(*x, *y, colour, opacity))

    def shade(
        self,
        colour: str,
        opacity: float,
        x: tuple[float, float] = (-np.inf, np.inf),
        y: tuple[float, float] = (-np.inf, np.inf),
    ) -> None:
        """A stretch of x or y."""
        self.below.append(marks.Block(*x, *y, colour, opacity, counts=False))

    def level(
        self, y: float, colour: str, width: float = 1.4, dash: marks.Dash = marks.SOLID
    ) -> None:
        """A horizontal line, always to be seen."""
        self.drawn.append(marks.Rule(y, colour, width, dash, counts=True))

    def moment(
        self, x: float, colour: str, width: float = 1.8, dash: marks.Dash = marks.SOLID
    ) -> None:
        """A vertical line."""
        self.drawn.append(marks.Rule(x, colour, width, dash, upright=True))

    def note(self, note: marks.Note) -> None:
        """Text."""
        self.drawn.append(note)

    def reach(self, axis: int) -> tuple[float, float]:
        """Lowest and highest value of x (0) or y (1); infinities where there is none."""
        low, high = np.inf, -np.inf
        for mark in (*self.below, *self.drawn):
            values = mark.extent()[axis]
            values = values[np.isfinite(values)]
            if values.size:
                low, high = min(low, float(values.min())), max(high, float(values.max()))
        return low, high
