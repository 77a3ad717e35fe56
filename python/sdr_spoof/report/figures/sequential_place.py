"""Where satellites and DME stations stand, and how far the fix is from where the INS says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import style
from .looks import draw_looks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes
    from numpy.typing import NDArray

    from .looks import Look

ALL, DRIFT = "all satellites", "expected of the INS's drift"
"""Names of lines; others are fixes without some satellites."""


def draw_places(
    looks: Sequence[Look],
    time_s: NDArray[np.float64],
    offsets_m: Mapping[str, NDArray[np.float64]],
    alarm_s: float | None,
) -> bytes:
    """Sky, and distances from the INS over time; PNG.

    Args:
        looks: satellites and stations.
        time_s: of the fixes, (K,).
        offsets_m: by the name of each kind of fix: east, north, up from the INS's place, (K, 3).
        alarm_s: first alarm.
    """

    def draw(figure: Figure) -> None:
        grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.5))
        axes: PolarAxes = figure.add_subplot(grid[:, 0], projection="polar")  # type: ignore[assignment]
        draw_looks(axes, looks)
        level = figure.add_subplot(grid[0, 1])
        height = figure.add_subplot(grid[1, 1], sharex=level)
        colours = {ALL: "#0072b2" if alarm_s is None else style.ALARM, DRIFT: style.INK}
        for name, offset in offsets_m.items():
            colour = colours.get(name, "#00694f")
            level.plot(time_s, np.hypot(*offset[:, :2].T), color=colour, label=name)
            height.plot(time_s, offset[:, 2], color=colour)
        if alarm_s is not None:
            for axis in (level, height):
                axis.axvline(alarm_s, color=style.ALARM, lw=0.8, ls=":")
        level.set_title("GNSS fix, from where the INS says")
        level.set(ylabel="horizontal (m)", ylim=(0, None))
        level.legend(loc="upper left")
        height.set(ylabel="height (m)", xlabel="time (s)")

    return style.png(draw, 10.0, 4.6)
