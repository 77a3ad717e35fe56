"""Where the satellites stood, seen from the receiver."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.route import ALARM_COLOURS, Alarm

from . import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes

    from sdr_spoof.route import Route, SatelliteView


def draw_sky(route: Route) -> str:
    """Azimuth and elevation of each satellite over the recording, coloured by what was said of it.

    A dot is where it stood last; hollow where the last fix did not use it.
    """

    def draw(figure: Figure) -> None:
        axes: PolarAxes = figure.add_axes(PLACE, projection="polar")  # type: ignore[assignment]
        axes.set_theta_zero_location("N")
        axes.set_theta_direction(-1)
        axes.set_ylim(0, 90)
        axes.set_yticks([30, 60, 90], ["60°", "30°", ""])
        axes.set_xticks(
            np.radians(np.arange(0, 360, 45)), ["N", "NE", "E", "SE", "S", "SW", "W", "NW"]
        )
        for satellite in route.satellites:
            _draw_satellite(axes, satellite)
        for alarm in Alarm:
            axes.plot([], [], "o", color=ALARM_COLOURS[alarm], label=LABELS[alarm])
        axes.plot([], [], "o", color=style.MUTED, fillstyle="none", label="not used at the end")
        axes.legend(loc="lower left", bbox_to_anchor=(1.02, 0.0))

    return style.render(draw, WIDTH_IN, HEIGHT_IN, placed=True)


WIDTH_IN, HEIGHT_IN = 6.6, 4.8
PLACE = (0.06, 0.065, 0.87 * HEIGHT_IN / WIDTH_IN, 0.87)
"""A square."""
LABELS = {
    Alarm.NONE: "no alarm",
    Alarm.SUSPECT: "suspect",
    Alarm.SPOOFED: "spoofed",
}


def _draw_satellite(axes: PolarAxes, satellite: SatelliteView) -> None:
    seen = np.flatnonzero(np.isfinite(satellite.elevation_deg) & (satellite.elevation_deg >= 0))
    if not seen.size:
        return
    theta = np.radians(satellite.azimuth_deg[seen])
    radius = 90.0 - satellite.elevation_deg[seen]
    alarm = Alarm(int(satellite.alarm[seen].max()))
    colour = ALARM_COLOURS[alarm]
    axes.plot(theta, radius, color=colour, linewidth=2, solid_capstyle="round", alpha=0.5)
    fill = "full" if satellite.used[seen[-1]] else "none"
    axes.plot(theta[-1:], radius[-1:], "o", color=colour, markersize=9, fillstyle=fill)
    axes.annotate(
        satellite.name,
        (theta[-1], radius[-1]),
        xytext=(7, 5),
        textcoords="offset points",
        fontsize=9,
        fontweight="bold",
    )
