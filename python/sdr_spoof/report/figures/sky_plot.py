"""Where the satellites stood, seen from the receiver."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.route import ALARM_COLOURS, Alarm

from . import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes
    from numpy.typing import NDArray

    from sdr_spoof.route import Route, SatelliteView


def draw_sky(route: Route) -> bytes:
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
        dots = {s.name: at for s in route.satellites if (at := _draw_satellite(axes, s))}
        for name, offset in label_offsets(dots).items():
            _name(axes, name, dots[name], offset)
        for alarm in Alarm:
            axes.plot([], [], "o", color=ALARM_COLOURS[alarm], label=LABELS[alarm])
        axes.plot([], [], "o", color=style.MUTED, fillstyle="none", label="not used at the end")
        axes.legend(loc="lower left", bbox_to_anchor=(1.02, 0.0))

    return style.png(draw, WIDTH_IN, HEIGHT_IN, placed=True)


WIDTH_IN, HEIGHT_IN = 6.6, 4.8
PLACE = (0.06, 0.065, 0.87 * HEIGHT_IN / WIDTH_IN, 0.87)
"""A square."""
LABELS = {
    Alarm.NONE: "no alarm",
    Alarm.SUSPECT: "suspect",
    Alarm.SPOOFED: "spoofed",
}


Place = tuple[float, float]
"""Azimuth in rad, distance from the zenith in degrees; or right and up in points."""
POINTS_PER_DEG = 0.5 * 0.87 * HEIGHT_IN * 72.0 / 90.0
LABEL = (26.0, 10.0)
"""Size of a name in points."""
AWAY = 7.0
"""Of a name from the middle of its dot."""
DOT = 5.0
"""Radius of a dot."""


def _draw_satellite(axes: PolarAxes, satellite: SatelliteView) -> Place | None:
    """Where its dot is; None where it was not seen."""
    seen = np.flatnonzero(np.isfinite(satellite.elevation_deg) & (satellite.elevation_deg >= 0))
    if not seen.size:
        return None
    theta = np.radians(satellite.azimuth_deg[seen])
    radius = 90.0 - satellite.elevation_deg[seen]
    alarm = Alarm(int(satellite.alarm[seen].max()))
    colour = ALARM_COLOURS[alarm]
    axes.plot(theta, radius, color=colour, linewidth=2, solid_capstyle="round", alpha=0.5)
    fill = "full" if satellite.used[seen[-1]] else "none"
    axes.plot(theta[-1:], radius[-1:], "o", color=colour, markersize=9, fillstyle=fill)
    return float(theta[-1]), float(radius[-1])


def label_offsets(dots: dict[str, Place]) -> dict[str, Place]:
    """Where each name stands beside its dot, its lower left corner in points.

    The first place round the dot that is clear of other dots and of names, or the clearest.
    """
    at = {
        name: POINTS_PER_DEG * radius * np.array([np.sin(theta), np.cos(theta)])
        for name, (theta, radius) in dots.items()
    }
    half = 0.5 * np.array(LABEL)
    taken: list[NDArray[np.float64]] = []
    chosen: dict[str, Place] = {}
    for name, dot in at.items():
        others = [place for other, place in at.items() if other != name]
        corner = max(_corners(), key=lambda c: _room(dot + c + half, others, taken))
        taken.append(dot + corner + half)
        chosen[name] = float(corner[0]), float(corner[1])
    return chosen


def _corners() -> list[NDArray[np.float64]]:
    """Lower left corners of a name round its dot: right and left of it, above and below."""
    width, height = LABEL
    ups = 0.4 * AWAY, -0.5 * height, -height - 0.4 * AWAY
    beside = [(right, up) for up in ups for right in (AWAY, -AWAY - width)]
    return [np.array(c) for c in (*beside, (-0.5 * width, AWAY), (-0.5 * width, -AWAY - height))]


def _room(
    middle: NDArray[np.float64],
    dots: list[NDArray[np.float64]],
    names: list[NDArray[np.float64]],
) -> float:
    """By how much a name with its middle here clears dots and other names' middles; 0 if all."""
    half = 0.5 * np.array(LABEL)
    from_dots = [np.max(np.abs(middle - dot) - half) - DOT for dot in dots]
    from_names = [np.max(np.abs(middle - name) - 2.0 * half) for name in names]
    return float(min([0.0, *from_dots, *from_names]))


def _name(axes: PolarAxes, name: str, dot: Place, offset: Place) -> None:
    axes.annotate(
        name,
        dot,
        xytext=offset,
        textcoords="offset points",
        fontsize=9,
        fontweight="bold",
        annotation_clip=False,
    )
