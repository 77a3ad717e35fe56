"""A satellite without an alarm: what was tested, against its thresholds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.signals import signal_spec

from . import style

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .panels import Look, Panel
    from .sheet import Sheets


@dataclass(frozen=True)
class QuietFrame:
    """What the pictures of all satellites with the same signals and tests share."""

    signals: tuple[str, ...]
    duration_s: float
    looks: tuple[Look, ...]

    @property
    def size_in(self) -> tuple[float, float]:
        """Width and height in inches."""
        return 10.0, sum(look.height_in for look in self.looks) + 0.9

    def build(self, figure: Figure) -> None:
        """One panel below the other."""
        height_in = self.size_in[1]
        places = {
            **{"left": 0.085, "right": 0.987, "hspace": 0.32},
            **{"bottom": 0.48 / height_in, "top": 1 - 0.58 / height_in},
        }
        panels = figure.subplots(
            len(self.looks), 1, sharex=True, squeeze=False, gridspec_kw=places
        )[:, 0]
        for axes, look in zip(panels, self.looks, strict=True):
            look.dress(axes)
            axes.yaxis.set_label_coords(-0.055, 0.5)
        panels[-1].set_xlim(0, self.duration_s)
        panels[-1].set_xlabel("Time (s)")
        figure.legend(
            [style.sample(style.colour(signal), width=1.8) for signal in self.signals],
            [signal_spec(signal).composite for signal in self.signals],
            loc="upper center",
            ncols=5,
            handlelength=2.4,
        )


@dataclass(frozen=True)
class QuietDrawing:
    """The tests of one satellite."""

    frame: QuietFrame
    panels: tuple[Panel, ...]

    @classmethod
    def of(
        cls, panels: Iterable[Panel], signals: Iterable[str], duration_s: float
    ) -> QuietDrawing | None:
        """None where nothing was tested, as in a recording that was broken off early."""
        panels = tuple(panels)
        looks = tuple(panel.look for panel in panels)
        return cls(QuietFrame(tuple(signals), duration_s, looks), panels) if panels else None

    def png(self, sheets: Sheets) -> bytes:
        """The picture."""
        return sheets.of(self.frame).png(self._fill)

    def _fill(self, axes: Sequence[Axes]) -> None:
        for one, panel in zip(axes, self.panels, strict=True):
            panel.fill(one)
