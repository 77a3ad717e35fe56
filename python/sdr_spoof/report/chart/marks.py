"""What a panel shows: lines, dots, bars, shaded bands, rules and notes, in units of the data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from . import svg
from .thin import thinned

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .scale import Scale

Extent = tuple["NDArray[np.float64]", "NDArray[np.float64]"]
Dash = tuple[float, ...]
SOLID: Dash = ()
NOTHING: NDArray[np.float64] = np.empty(0)


@dataclass(frozen=True)
class Frame:
    """The area of a panel within its axes."""

    width: float
    height: float
    x: Scale
    y: Scale

    def points(
        self, x: NDArray[np.float64], y: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Places of points, from the upper left corner."""
        return self.width * self.x.at(x), self.height * (1.0 - self.y.at(y))

    def across(self, values: Sequence[float], *, upright: bool) -> str:
        """Path data of lines across the panel at values of x (upright) or of y."""
        places = (
            self.width * self.x.at(values) if upright else self.height * (1 - self.y.at(values))
        )
        far = round(svg.FINE * (self.height if upright else self.width))
        fine = np.clip(np.rint(svg.FINE * places), -svg.FAR, svg.FAR).astype(np.int64).tolist()
        return "".join(f"M{at} 0v{far}" if upright else f"M0 {at}h{far}" for at in fine)

    def spot(self, x: float, y: float) -> tuple[float, float]:
        """Place of one point."""
        at_x, at_y = self.points(np.array([x]), np.array([y]))
        return float(at_x[0]), float(at_y[0])


class Mark(Protocol):
    """Something in a panel."""

    def extent(self) -> Extent:
        """Values in x and in y that must be seen."""

    def draw(self, frame: Frame) -> str:
        """SVG in units of 1 / FINE."""


def stroke(colour: str, width: float, dash: Dash = SOLID) -> dict[str, str | float | None]:
    """Attributes of a line; dashes are in widths of it."""
    dashes = " ".join(f"{round(svg.FINE * width * d, 1):g}" for d in dash)
    return {"stroke": colour, "stroke_width": svg.FINE * width, "stroke_dasharray": dashes or None}


@dataclass(frozen=True)
class Line:
    """A line through points, broken where one is NaN."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    colour: str
    width: float
    dash: Dash = SOLID
    opacity: float | None = None

    def extent(self) -> Extent:
        """All points."""
        return self.x, self.y

    def draw(self, frame: Frame) -> str:
        """A path."""
        shown = thinned(self.x, self.y, most=max(round(2 * frame.width), 2))
        data = svg.path(*frame.points(*shown))
        pen = stroke(self.colour, self.width, self.dash)
        return svg.element("path", d=data, fill="none", opacity=self.opacity, **pen) if data else ""


@dataclass(frozen=True)
class Area:
    """Shaded between two lines over the same x."""

    x: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    colour: str
    opacity: float

    def extent(self) -> Extent:
        """Both lines."""
        return np.tile(self.x, 2), np.concatenate([self.low, self.high])

    def draw(self, frame: Frame) -> str:
        """A polygon for each unbroken piece."""
        known = np.isfinite(self.low) & np.isfinite(self.high)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], known.astype(np.int8), [0]])))
        data = ""
        for a, b in edges.reshape(-1, 2).tolist():
            x = np.concatenate([self.x[a:b], self.x[a:b][::-1]])
            y = np.concatenate([self.high[a:b], self.low[a:b][::-1]])
            data += svg.path(*frame.points(x, y)) + "z"
        return svg.element("path", d=data, fill=self.colour, opacity=self.opacity) if data else ""


@dataclass(frozen=True)
class Dots:
    """A dot, ring or cross at each point."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    colour: str
    size: float
    shape: str = "dot"

    def extent(self) -> Extent:
        """All points."""
        return self.x, self.y

    def draw(self, frame: Frame) -> str:
        """One path."""
        known = np.isfinite(self.x) & np.isfinite(self.y)
        places = np.stack(frame.points(self.x[known], self.y[known]), axis=1)
        half = round(svg.FINE * self.size / 2)
        sign = {
            "dot": "h0",
            "cross": f"m{-half} {-half}l{2 * half} {2 * half}m0 {-2 * half}l{-2 * half} {2 * half}",
        }[self.shape]
        fine = np.clip(np.rint(svg.FINE * places), -svg.FAR, svg.FAR).astype(np.int64)
        data = "".join(f"M{x} {y}{sign}" for x, y in fine.tolist())
        width = self.size if self.shape == "dot" else 1.4
        pen = stroke(self.colour, width)
        return (
            svg.element("path", d=data, fill="none", stroke_linecap="round", **pen) if data else ""
        )


@dataclass(frozen=True)
class Block:
    """A rectangle; one without ends in a direction fills the panel in it."""

    left: float = -np.inf
    right: float = np.inf
    bottom: float = -np.inf
    top: float = np.inf
    colour: str = "#000"
    opacity: float | None = None
    counts: bool = True
    """Whether it must be seen whole."""

    def extent(self) -> Extent:
        """Its finite edges."""
        sides = np.array([self.left, self.right]), np.array([self.bottom, self.top])
        return sides if self.counts else (NOTHING, NOTHING)

    def draw(self, frame: Frame) -> str:
        """A rectangle."""
        x0, x1 = (self._at(frame.x, v, frame.width) for v in (self.left, self.right))
        y0, y1 = (self._at(frame.y, v, frame.height) for v in (self.bottom, self.top))
        fine = [svg.FINE * v for v in (x0, frame.height - y1, x1 - x0, y1 - y0)]
        keys = ("x", "y", "width", "height")
        return svg.element(
            "rect", fill=self.colour, opacity=self.opacity, **dict(zip(keys, fine, strict=True))
        )

    def _at(self, scale: Scale, value: float, length: float) -> float:
        share = float(np.clip(scale.at(np.clip(value, scale.low, scale.high)), 0.0, 1.0))
        return length * share


@dataclass(frozen=True)
class Rule:
    """A line across the panel, at a value of x (upright) or of y."""

    at: float
    colour: str
    width: float
    dash: Dash = SOLID
    upright: bool = False
    counts: bool = False
    """Whether it must be seen."""

    def extent(self) -> Extent:
        """The value, if it counts."""
        value = np.array([self.at]) if self.counts else NOTHING
        return (value, NOTHING) if self.upright else (NOTHING, value)

    def draw(self, frame: Frame) -> str:
        """A straight path."""
        data = frame.across([self.at], upright=self.upright)
        return svg.element("path", d=data, **stroke(self.colour, self.width, self.dash))


@dataclass(frozen=True)
class Note:
    """Text at a point of the data, or at a part of the panel (``inside``)."""

    x: float
    y: float
    content: str
    colour: str
    size: float = 11.0
    anchor: str = "start"
    bold: bool = False
    inside: bool = False
    shift: tuple[float, float] = field(default=(0.0, 0.0))
    """Right and down, in units of the picture."""

    def extent(self) -> Extent:
        """None: it must find room."""
        return NOTHING, NOTHING

    def draw(self, frame: Frame) -> str:
        """Text; it is drawn over the panel, so that its end may stand out."""
        inner = self.x * frame.width, (1.0 - self.y) * frame.height
        x, y = inner if self.inside else frame.spot(self.x, self.y)
        return svg.text(
            x + self.shift[0],
            y + self.shift[1],
            self.content,
            fill=self.colour,
            font_size=self.size,
            text_anchor=None if self.anchor == "start" else self.anchor,
            font_weight="bold" if self.bold else None,
        )
