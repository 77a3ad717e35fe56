"""Where an array's satellites should be in the sky, and the way that the vehicle went."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import style
from .looks import draw_looks

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes
    from numpy.typing import NDArray

    from .looks import Look


def draw_way(
    looks: Sequence[Look], place_m: NDArray[np.float64], alarms: Sequence[tuple[str, int]]
) -> bytes:
    """Sky, if anything is known of it, and a map; PNG.

    Args:
        looks: satellites by their orbits.
        place_m: of the vehicle: north, east, down from where it began, (E, 3).
        alarms: what was found where on the way: name and epoch.
    """

    def draw(figure: Figure) -> None:
        if looks:
            sky: PolarAxes = figure.add_subplot(1, 2, 1, projection="polar")  # type: ignore[assignment]
            draw_looks(sky, looks)
        axes = figure.add_subplot(1, 2, 2) if looks else figure.subplots()
        axes.plot(place_m[:, 1], place_m[:, 0], color=style.INK)
        axes.plot(place_m[:1, 1], place_m[:1, 0], "o", color=style.INK, ms=5, label="start")
        for name, epoch in alarms:
            at = place_m[epoch]
            axes.plot(at[1], at[0], "o", color=style.ALARM, ms=6, label=f"alarm, {name}")
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel="east (m)", ylabel="north (m)")
        axes.set_title("Way of the vehicle, by the INS")
        axes.legend(loc="best")

    return style.png(draw, 10.0, 4.4)
