"""The fixes: track on a plain map, scatter, geometry over time, and what is left unexplained."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.route import ALARM_COLOURS, Alarm, Quality

from . import style
from .scatter import scatter_of
from .sky_plot import LABELS

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from sdr_spoof.route import Route

    from .sheet import Sheets

SEMI_MAJOR_M, FLATTENING = 6_378_137.0, 1 / 298.257223563
"""WGS-84."""
BESIDE = {"left": 0.068, "right": 0.992, "bottom": 0.095, "top": 0.87, "wspace": 0.16}
BELOW = {"left": 0.075, "right": 0.95, "bottom": 0.07, "top": 0.985, "hspace": 0.32}
"""Where panels stand beside and below each other."""


@dataclass(frozen=True)
class RouteDrawing:
    """A picture of a route."""

    draw: Callable[[Route], bytes]
    route: Route

    def png(self, _: Sheets) -> bytes:
        """Draw it."""
        return self.draw(self.route)


def local_m(route: Route) -> NDArray[np.float64]:
    """East, north, up of each epoch against the median fix, (E, 3) m.

    By the ellipsoid's two radii there: 1 cm at 1 km, 1 % at 100 km.
    """
    place = np.stack([route.latitude_deg, route.longitude_deg, route.height_m], axis=1)
    middle = np.nanmedian(place, axis=0) if route.fixed.any() else np.zeros(3)
    sine, cosine = np.sin(np.radians(middle[0])), np.cos(np.radians(middle[0]))
    squared = FLATTENING * (2.0 - FLATTENING)
    bend = 1.0 - squared * sine * sine
    normal = SEMI_MAJOR_M / np.sqrt(bend)
    meridian = normal * (1.0 - squared) / bend
    turn = (place[:, 1] - middle[1] + 180.0) % 360.0 - 180.0
    east = np.radians(turn) * (normal + middle[2]) * cosine
    north = np.radians(place[:, 0] - middle[0]) * (meridian + middle[2])
    return np.stack([east, north, place[:, 2] - middle[2]], axis=1)


def draw_track(route: Route) -> bytes:
    """Map and scatter side by side."""

    def draw(figure: Figure) -> None:
        track, scatter = figure.subplots(1, 2, gridspec_kw=BESIDE)
        local = local_m(route)
        track.plot(local[:, 0], local[:, 1], color=style.GRID, zorder=1)
        _dots(track, route, local[:, 0], local[:, 1])
        track.set_title("Track, about its median")
        spread, title = scatter_of(route, local)
        _dots(scatter, route, spread[:, 0], spread[:, 1])
        scatter.set_title(title)
        for axes in (track, scatter):
            axes.set_aspect("equal", adjustable="datalim")
            axes.set_xlabel("East (m)")
            axes.set_ylabel("North (m)")
        for alarm in Alarm:
            track.plot([], [], "o", color=ALARM_COLOURS[alarm], label=LABELS[alarm])
        track.plot([], [], "x", color=style.INK, label="not to be trusted")
        figure.legend(loc="upper right", ncols=len(Alarm) + 1)

    return style.png(draw, 10, 4.8, placed=True)


def _dots(axes: Axes, route: Route, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    for alarm in Alarm:
        kept = np.flatnonzero(route.fixed & (route.alarm == alarm))
        kept = kept[:: -(-max(kept.size, 1) // style.MOST_POINTS)]
        axes.plot(x[kept], y[kept], ".", color=ALARM_COLOURS[alarm], markersize=6, zorder=2)
    doubt = route.quality == Quality.SUSPECT
    axes.plot(x[doubt], y[doubt], "x", color=style.INK, markersize=6, zorder=3)


def draw_geometry(route: Route) -> bytes:
    """Height, DOP, satellites used, and residuals over time."""

    def draw(figure: Figure) -> None:
        height, dop, residual = figure.subplots(3, 1, sharex=True, gridspec_kw=BELOW)
        time = route.sample_time_s
        _dots(height, route, time, local_m(route)[:, 2])
        height.set_ylabel("Up (m)")
        for column, label in enumerate(("position", "horizontal", "vertical")):
            dop.plot(*style.thinned(time, route.dop[:, column]), label=label)
        dop.set_ylabel("DOP")
        dop.set_ylim(bottom=0)
        used = np.sum([s.used for s in route.satellites], axis=0) if route.satellites else 0 * time
        count = dop.twinx()
        count.step(time, used, where="mid", color=style.MUTED, linewidth=1, label="satellites")
        count.set_ylabel("satellites used")
        count.set_ylim(0, max(float(np.max(used, initial=0)) + 1, 4))
        count.grid(False)
        count.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0))
        dop.legend(loc="lower left", ncols=3, bbox_to_anchor=(0.0, 1.0))
        _residuals(residual, route)
        residual.set_xlabel("Time (s)")

    return style.png(draw, 10, 6.4, placed=True)


def _residuals(axes: Axes, route: Route) -> None:
    """Of every satellite, in the colour of the signal; thick where it is spoofed.

    Shaded: their root mean square.
    """
    time, named = route.sample_time_s, set()
    every = [values for s in route.satellites for values in s.residual_m.values()]
    if every:
        known = np.isfinite(every)
        square = np.where(known, every, 0.0) ** 2
        rms = np.sqrt(square.sum(axis=0) / np.maximum(known.sum(axis=0), 1))
        thin_s, edge = style.thinned(time, rms)
        axes.fill_between(thin_s, -edge, edge, color=style.GRID, label="RMS", linewidth=0)
    for satellite in route.satellites:
        for signal, values in satellite.residual_m.items():
            label = signal if signal not in named else None
            named.add(signal)
            how: dict[str, Any] = {"linewidth": 0.7, "alpha": 0.55}
            line = style.thinned(time, values)
            axes.plot(*line, color=style.colour(signal), label=label, **how)
            bad = np.where(satellite.alarm == Alarm.SPOOFED, values, np.nan)
            if np.isfinite(bad).any():
                axes.plot(*style.thinned(time, bad), color=style.ALARM, linewidth=2)
    axes.set_ylabel("Residual (m)")
    if named:
        axes.legend(loc="lower left", ncols=6, bbox_to_anchor=(0.0, 1.0))
