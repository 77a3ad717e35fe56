"""Panels over time of what the tests say of one satellite: what stands still, and the lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from matplotlib.ticker import FuncFormatter, NullLocator

from . import style
from .style import SOLID, Dash

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

QUIET: dict[str, Any] = {"color": "#009e73", "alpha": 0.13, "linewidth": 0}
BOUND: dict[str, Any] = {"color": "#00755a", "linewidth": 1.0, "linestyle": (0, (4, 2))}


@dataclass(frozen=True)
class Entry:
    """Entry of a legend."""

    text: str
    colour: str
    dash: Dash = SOLID


@dataclass(frozen=True)
class Note:
    """Words in a corner of a panel."""

    text: str
    below: bool


@dataclass(frozen=True)
class Look:
    """What stands still in a panel; equal looks are drawn alike."""

    label: str
    height_in: float
    quiet: tuple[float, float] | None = None
    """Between these noise stays."""
    bounds: tuple[float, ...] = ()
    symlog: tuple[float, float] | None = None
    """The axis is linear up to the first, and logarithmic beyond; the second is Matplotlib's
    ``linscale``."""
    legend: tuple[Entry, ...] = ()
    columns: int = 1
    note: Note | None = None

    def dress(self, axes: Axes) -> None:
        """Draw it."""
        axes.set_ylabel(self.label)
        if self.symlog is not None:
            axes.set_yscale("symlog", linthresh=self.symlog[0], linscale=self.symlog[1])
            axes.yaxis.set_minor_locator(NullLocator())
            axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        if self.quiet is not None:
            axes.axhspan(*self.quiet, **QUIET)
        for bound in self.bounds:
            axes.axhline(bound, **BOUND)
        if self.legend:
            self._explain(axes)
        if self.note is not None:
            place = (0.995, 0.04, "bottom") if self.note.below else (0.995, 0.96, "top")
            how: dict[str, Any] = {"fontsize": 8, "color": style.MUTED, "ha": "right"}
            axes.text(*place[:2], self.note.text, transform=axes.transAxes, va=place[2], **how)

    def _explain(self, axes: Axes) -> None:
        axes.legend(
            [style.sample(e.colour, e.dash, 1.2) for e in self.legend],
            [e.text for e in self.legend],
            loc="lower left",
            bbox_to_anchor=(0.0, 0.98),
            borderaxespad=0.0,
            fontsize=8,
            ncols=self.columns,
            handlelength=1.6,
            columnspacing=1.4,
        )


@dataclass(frozen=True, eq=False)
class Stroke:
    """A line, thinned."""

    time_s: NDArray[Any]
    value: NDArray[Any]
    colour: str
    dash: Dash = SOLID
    width: float = 1.2


@dataclass(frozen=True, eq=False)
class Panel:
    """A panel of one satellite."""

    look: Look
    strokes: tuple[Stroke, ...]
    limits: tuple[float, float] | None = None
    ticks: tuple[float, ...] | None = None

    def fill(self, axes: Axes) -> None:
        """Draw the lines on axes that have its look."""
        for one in self.strokes:
            how: dict[str, Any] = {
                "color": one.colour,
                "linestyle": one.dash,
                "linewidth": one.width,
            }
            axes.plot(one.time_s, one.value, **how)
        if self.limits is not None:
            axes.set_ylim(*self.limits)
        if self.ticks is not None:
            axes.set_yticks(self.ticks)
