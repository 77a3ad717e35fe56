"""The fixes: track on a plain map, scatter, geometry over time, and what is left unexplained."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.report.chart import Axis, Drawing, Entry, Grid, Panel, drawing
from sdr_spoof.route import ALARM_COLOURS, Alarm, Quality

from . import style
from .sky_plot import LABELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.route import Route

SEMI_MAJOR_M, FLATTENING = 6_378_137.0, 1 / 298.257223563
"""WGS-84."""


COLUMNS = ("#0072b2", "#e08214", "#009e73")
"""Colours of the kinds of DOP."""


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


def draw_track(route: Route) -> Drawing:
    """Map and scatter side by side; of a moving track about the mean of eleven fixes."""
    local = local_m(route)
    spread = local - _smooth(local)
    made = []
    titles = "Track, about its median", f"Scatter: {_rms(spread[:, :2])}"
    for title, places in zip(titles, (local, spread), strict=True):
        panel = Panel(title, Axis("East (m)"), Axis("North (m)"), equal=True)
        if places is local:
            panel.line(local[:, 0], local[:, 1], style.GRID, 1.8)
        _dots(panel, route, places[:, 0], places[:, 1])
        made.append(panel)
    legend = [Entry(LABELS[alarm], ALARM_COLOURS[alarm], shape="dot") for alarm in Alarm]
    legend.append(Entry("not to be trusted", style.INK, shape="cross"))
    return drawing(Grid([made], [360.0]), legend=legend)


def _dots(panel: Panel, route: Route, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    for alarm in Alarm:
        kept = np.flatnonzero(route.fixed & (route.alarm == alarm))
        kept = kept[:: -(-max(kept.size, 1) // style.MOST_POINTS)]
        panel.dots(x[kept], y[kept], ALARM_COLOURS[alarm], 4.5)
    doubt = route.quality == Quality.SUSPECT
    panel.dots(x[doubt], y[doubt], style.INK, 8.0, "cross")


def _smooth(values: NDArray[np.float64], count: int = 10) -> NDArray[np.float64]:
    """Median of a static track; of a moving one the mean of each fix and those around."""
    flat = values[np.isfinite(values).all(axis=1), :2]
    if not len(flat) or np.ptp(flat, axis=0).max() < STATIC_M:
        return np.zeros_like(values)
    kernel = np.ones(count + 1)
    known = np.isfinite(values[:, 0])
    weight = np.convolve(known, kernel, "same")
    sums = [np.convolve(np.where(known, v, 0.0), kernel, "same") for v in values.T]
    mean = np.stack(sums, axis=1) / np.maximum(weight, 1)[:, None]
    mean[weight < kernel.size] = np.nan  # one-sided: not in the middle of its fixes
    return np.asarray(mean)


STATIC_M = 20.0
"""A track that keeps within this is drawn as that of a receiver at rest."""


def _rms(values: NDArray[np.float64]) -> str:
    known = values[np.isfinite(values).all(axis=1)]
    if not known.size:
        return "no fix"
    return f"{np.sqrt((known**2).sum(axis=1).mean()):.2g} m RMS"


def draw_geometry(route: Route) -> Drawing:
    """Height, DOP, satellites used, and residuals over time."""
    time = route.sample_time_s
    height = Panel(y=Axis("Up (m)"))
    _dots(height, route, time, local_m(route)[:, 2])
    dop = Panel(y=Axis("DOP", low=0.0))
    for column, label in enumerate(("position", "horizontal", "vertical")):
        dop.line(time, route.dop[:, column], COLUMNS[column])
        dop.entries.append(Entry(label, COLUMNS[column]))
    used = np.sum([s.used for s in route.satellites], axis=0) if route.satellites else 0 * time
    most = max(float(np.max(used, initial=0)) + 1, 4)
    count = Panel(y=Axis("Satellites\nused", 0.0, most))
    count.line(*_steps(time, np.asarray(used, dtype=np.float64)), style.MUTED)
    residual = _residuals(route)
    residual.x.label = "Time (s)"
    panels = [height, dop, count, residual]
    heights = [115.0, 95.0, 70.0, 140.0]
    return drawing(Grid([[panel] for panel in panels], heights, share_x=True))


def _steps(
    time_s: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A value holds half way to those beside it."""
    if time_s.size < 2:
        return time_s, values
    middle = 0.5 * (time_s[1:] + time_s[:-1])
    edges = np.concatenate([time_s[:1], np.repeat(middle, 2), time_s[-1:]])
    return edges, np.repeat(values, 2)


def _residuals(route: Route) -> Panel:
    """Of every satellite, in the colour of the signal; thick where it is spoofed."""
    panel, time = Panel(y=Axis("Residual (m)")), route.sample_time_s
    named: dict[str, Entry] = {}
    for satellite in route.satellites:
        for signal, values in satellite.residual_m.items():
            colour = style.colour(signal)
            named.setdefault(signal, Entry(signal, colour))
            panel.line(time, values, colour, 1.5, opacity=0.6)
            bad = np.where(satellite.alarm == Alarm.SPOOFED, values, np.nan)
            if np.isfinite(bad).any():
                panel.line(time, bad, style.ALARM, 2.6)
    panel.entries.extend(named.values())
    return panel
