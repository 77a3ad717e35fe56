"""Pictures of one kind on one figure: what all of them share is drawn once.

Titles, time axes and their labels take most of a picture's time, and they are the same for each
satellite. A sheet draws them once and keeps the pixels (what Matplotlib calls blitting); a picture
adds its lines and the axes that go with them. It has the same bytes whatever was drawn on its
sheet before.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .style import DPI, RC, png_of, undisturbed

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes


class Frame(Protocol):
    """What all pictures of a kind share; equal frames look the same."""

    @property
    def size_in(self) -> tuple[float, float]:
        """Width and height in inches."""

    def build(self, figure: Figure) -> None:
        """Make the axes with what stands still: horizontal axes with their limits, titles, legends.

        A vertical axis whose limits are set here stands still too; the others move.
        """

    def __hash__(self) -> int:
        """Frames are keys."""


class Sheet:
    """A figure to draw on again and again."""

    def __init__(self, frame: Frame) -> None:
        """Draw what stands still."""
        with rc_context(RC), undisturbed():  # type: ignore[arg-type]
            figure = Figure(figsize=frame.size_in, dpi=DPI)
            self._canvas = FigureCanvasAgg(figure)
            frame.build(figure)
            self._panels = figure.axes
            self._moving = [axes for axes in self._panels if axes.get_autoscaley_on()]
            self._own = {id(artist) for axes in self._panels for artist in _content(axes)}
            for axes in self._panels:
                for artist in self._on_top(axes):
                    artist.set_animated(True)
            self._canvas.draw()  # type: ignore[no-untyped-call]
            background = self._canvas.copy_from_bbox(figure.bbox)  # type: ignore[no-untyped-call]
            self._background = background

    def png(self, fill: Callable[[Sequence[Axes]], None]) -> bytes:
        """One picture: ``fill`` draws on the axes, and sets limits and ticks of moving ones."""
        with rc_context(RC), undisturbed():  # type: ignore[arg-type]
            try:
                fill(self._panels)
                self._canvas.restore_region(self._background)  # type: ignore[no-untyped-call]
                for axes in self._panels:
                    for artist in self._on_top(axes):
                        axes.draw_artist(artist)
                return png_of(self._canvas)
            finally:
                self._clear()

    def _on_top(self, axes: Axes) -> list[Artist]:
        """What is drawn anew in each picture, from the lowest to the topmost."""
        moving = [axes.yaxis] if axes in self._moving else []
        drawn = [*moving, *_content(axes), *axes.spines.values()]
        return sorted(drawn, key=lambda artist: artist.get_zorder())

    def _clear(self) -> None:
        """As it was before the picture."""
        for axes in self._panels:
            for artist in _content(axes):
                if id(artist) not in self._own:
                    artist.remove()
            axes.relim()
        for axes in self._moving:
            axes.set_autoscaley_on(True)


def _content(axes: Axes) -> list[Artist]:
    """What stands in the coordinates of the data."""
    return [*axes.lines, *axes.patches, *axes.collections, *axes.texts]


class Sheets:
    """The sheets of a report, each made when it is needed first."""

    def __init__(self) -> None:
        """None yet."""
        self._made: dict[Hashable, Sheet] = {}

    def of(self, frame: Frame) -> Sheet:
        """The sheet of a frame."""
        if frame not in self._made:
            self._made[frame] = Sheet(frame)
        return self._made[frame]
