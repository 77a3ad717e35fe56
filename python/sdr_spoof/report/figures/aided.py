"""Aided navigation: map, error with protection levels, statistics, satellites, rate residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aided.records import GUARDS, Guard, Use, stretches
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu_matrix

from . import style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from sdr_spoof.aided.records import AidedTrack, Monitor

AIDED, ALONE, LEVEL, SMOOTHED = "#0072b2", "#e08214", "#009e73", "#a0307a"
GUARD_COLOURS = {
    Guard.STARTING: "#dfe4e9",
    Guard.TRUSTED: "#00694f",
    Guard.DECIDING: "#c98a00",
    Guard.PARTIAL: "#8263b0",
    Guard.COASTING: "#c0392b",
}
USE_COLOURS = {Use.USED: "#7fb69f", Use.EXCLUDED: "#c0392b", Use.NAMED: "#7a1f5c"}
USE_NAMES = {
    Use.USED: "used",
    Use.EXCLUDED: "left out by the filter",
    Use.NAMED: "called spoofed by the receiver",
}
SHADE = "#fbe9e6"


def draw_map(track: AidedTrack, truth_m: NDArray[np.float64] | None) -> str:
    """Ways of GNSS alone, of the aided receiver, also smoothed, and the true one if it is known."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        origin = _origin(track)
        alone = _local(track.alone_m, origin)
        axes.plot(*_line(alone), color=ALONE, linewidth=1.6, label="GNSS alone", zorder=2)
        if truth_m is not None:
            axes.plot(
                *_line(_local(truth_m, origin)),
                color=style.TRUTH,
                linewidth=3.2,
                alpha=0.25,
                label="truth",
                zorder=1,
            )
        aided = _local(track.position_m, origin)
        axes.plot(*_line(aided), color=AIDED, linewidth=1.6, label="aided", zorder=3)
        if track.smoothed is not None:
            later = _local(track.smoothed.position_m, origin)
            axes.plot(*_line(later), color=SMOOTHED, linewidth=1.1, label="smoothed", zorder=4)
        for state in (Guard.DECIDING, Guard.PARTIAL, Guard.COASTING):
            rows = np.flatnonzero(track.guard == state)
            if rows.size:
                rows = rows[:: -(-rows.size // 800)]
                name = GUARDS[state].split(":")[0]
                axes.plot(
                    aided[rows, 0],
                    aided[rows, 1],
                    "o",
                    color=GUARD_COLOURS[state],
                    markersize=9,
                    markeredgewidth=0,
                    alpha=0.3,
                    label=name,
                    zorder=1,
                )
        known = np.flatnonzero(np.isfinite(aided[:, 0]))
        if known.size:
            axes.plot(*aided[known[0], :2], "o", color=style.INK, markersize=6, zorder=5)
            axes.annotate(
                "start", tuple(aided[known[0], :2]), xytext=(6, 6), textcoords="offset points"
            )
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel("East (m)")
        axes.set_ylabel("North (m)")
        axes.legend(loc="best")

    return style.render(draw, 10, 6.0)


def draw_errors(track: AidedTrack, truth_m: NDArray[np.float64] | None) -> str:
    """Errors against the truth, or GNSS alone against the aided place, with protection levels."""

    def draw(figure: Figure) -> None:
        level, height = figure.subplots(2, 1, sharex=True)
        reference = track.position_m if truth_m is None else truth_m
        lines = {"GNSS alone": (track.alone_m, ALONE)}
        if truth_m is not None:
            lines["aided"] = (track.position_m, AIDED)
        if track.smoothed is not None:
            lines["smoothed"] = (track.smoothed.position_m, SMOOTHED)
        bounds = {level: track.horizontal_m, height: track.vertical_m}
        for axes, bound in bounds.items():
            axes.fill_between(track.time_s, 0, bound, color=LEVEL, alpha=0.13, linewidth=0)
            axes.plot(*style.thinned(track.time_s, bound), color=LEVEL, label="protection level")
        wrong = {level: track.horizontal_one_wrong_m, height: track.vertical_one_wrong_m}
        for axes, higher in wrong.items():
            if higher is not None:
                line = style.thinned(track.time_s, higher)
                axes.plot(*line, color=LEVEL, linestyle="--", label="one satellite wrong")
        for name, (place, colour) in lines.items():
            enu = _against(place, reference)
            away = np.hypot(enu[:, 0], enu[:, 1])
            level.plot(*style.thinned(track.time_s, away), color=colour, label=name)
            height.plot(*style.thinned(track.time_s, np.abs(enu[:, 2])), color=colour, label=name)
        what = "error" if truth_m is not None else "distance to aided"
        level.set_ylabel(f"Horizontal {what} (m)")
        height.set_ylabel(f"Vertical {what} (m)")
        for axes in bounds:
            _shade(axes, track)
            _compressed(axes, 10.0, [line.get_ydata() for line in axes.lines], both=False)
        level.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4)
        height.set_xlabel("Time (s)")

    return style.render(draw, 10, 5.6)


def draw_monitors(monitors: Sequence[Monitor], track: AidedTrack | None) -> str:
    """Each statistic by its threshold: from 1 on it says that something is wrong."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        top = 3.0
        for number, m in enumerate(monitors):
            ratio = m.value / m.threshold
            top = max(top, float(np.nanmax(ratio, initial=0.0)) * 1.5)
            axes.plot(*style.thinned(m.time_s, ratio), color=f"C{number}", label=m.name)
            if m.alarm_s is not None:
                axes.axvline(m.alarm_s, color=f"C{number}", linewidth=0.9, linestyle=":")
        axes.axhline(1.0, color=style.ALARM, linewidth=1.2, linestyle="--")
        axes.set_yscale("log")
        axes.set_ylim(1e-2, top)
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.set_ylabel("Statistic / threshold")
        axes.set_xlabel("Time (s)")
        if track is not None:
            _shade(axes, track)
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4)

    return style.render(draw, 10, 3.9)


def draw_satellites(track: AidedTrack) -> str:
    """A bar for each satellite, and one for what the filter makes of them."""

    def draw(figure: Figure) -> None:
        count = len(track.satellites)
        axes = figure.subplots()
        edge = np.append(track.time_s, track.time_s[-1:] + _step_s(track))
        for row, _ in enumerate(track.satellites):
            for use, colour in USE_COLOURS.items():
                _bar(axes, edge, track.use[:, row] == use, count - row, colour)
        for state, colour in GUARD_COLOURS.items():
            _bar(axes, edge, track.guard == state, 0, colour)
        axes.axhline(0.5, color=style.MUTED, linewidth=0.8)
        axes.set_yticks([*range(count, 0, -1), 0], [*track.satellites, "filter"])
        axes.set_ylim(-0.6, count + 0.6)
        axes.grid(visible=False)
        axes.set_xlabel("Time (s)")
        shown = {USE_NAMES[u]: c for u, c in USE_COLOURS.items() if (track.use == u).any()}
        shown |= {
            f"filter: {GUARDS[s].split(':')[0]}": c
            for s, c in GUARD_COLOURS.items()
            if (track.guard == s).any()
        }
        for name, colour in shown.items():
            axes.plot([], [], "s", color=colour, label=name, markersize=8)
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3)

    return style.render(draw, 10, 1.9 + 0.27 * len(track.satellites))


def draw_rates(residuals: Sequence[Monitor], track: AidedTrack | None) -> str:
    """Rate residuals east, north, up with their thresholds."""

    def draw(figure: Figure) -> None:
        panels = np.atleast_1d(figure.subplots(len(residuals), 1, sharex=True))
        for axes, m in zip(panels, residuals, strict=True):
            bound = m.threshold
            axes.fill_between(m.time_s, -bound, bound, color=LEVEL, alpha=0.13, linewidth=0)
            for sign in (-1, 1):
                axes.plot(*style.thinned(m.time_s, sign * bound), color=LEVEL, linewidth=1)
            axes.plot(*style.thinned(m.time_s, m.value), color=AIDED, linewidth=1)
            over = np.where(np.abs(m.value) > bound, m.value, np.nan)
            axes.plot(m.time_s, over, ".", color=style.ALARM, markersize=4)
            if m.alarm_s is not None:
                axes.axvline(m.alarm_s, color=style.ALARM, linewidth=1, linestyle=":")
            axes.set_ylabel(f"{m.name[:1].upper()}{m.name[1:]} ({m.unit})")
            largest = float(np.nanmax(bound, initial=1e-3))
            _compressed(axes, 2 * largest, [m.value, bound], both=True)
            if track is not None:
                _shade(axes, track)
        panels[-1].set_xlabel("Time (s)")

    return style.render(draw, 10, 1.0 + 1.9 * max(len(residuals), 1))


def _bar(
    axes: Axes, edge: NDArray[np.float64], where: NDArray[np.bool_], row: int, colour: str
) -> None:
    ends = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]))).reshape(-1, 2)
    parts = [(edge[a], edge[b] - edge[a]) for a, b in ends]
    axes.broken_barh(parts, (row - 0.38, 0.76), facecolors=colour, linewidth=0)


def _compressed(axes: Axes, linear: float, values: Sequence[object], *, both: bool) -> None:
    """A scale that is straight up to a value, and logarithmic beyond if there is much beyond."""
    largest = max(float(np.nanmax(np.abs(np.asarray(v, np.float64)), initial=0)) for v in values)
    if largest <= 3 * linear:
        top = 1.1 * largest or 1.0
        axes.set_ylim(-top if both else 0.0, top)
        return
    axes.set_yscale("symlog", linthresh=linear)
    whole = 10.0 ** np.arange(np.floor(np.log10(linear)), np.ceil(np.log10(largest)) + 1)
    ticks = whole[whole >= 0.5 * linear]
    axes.set_yticks([*(-ticks[::-1] if both else []), 0.0, *ticks])
    axes.set_yticks([], minor=True)
    axes.set_ylim(-1.5 * largest if both else 0.0, 1.5 * largest)
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")


def _step_s(track: AidedTrack) -> float:
    return float(np.median(np.diff(track.time_s))) if track.time_s.size > 1 else 1.0


def _shade(axes: Axes, track: AidedTrack) -> None:
    """Where the filter does not believe all satellites."""
    doubt = (track.guard != Guard.TRUSTED) & (track.guard != Guard.STARTING)
    for begin, end in stretches(track.time_s, doubt):
        axes.axvspan(begin, end + _step_s(track), color=SHADE, zorder=0, linewidth=0)


def _origin(track: AidedTrack) -> NDArray[np.float64]:
    """First place that is known, ECEF (3,)."""
    for places in (track.position_m, track.alone_m):
        known = np.flatnonzero(np.isfinite(places[:, 0]))
        if known.size:
            return np.asarray(places[known[0]])
    return np.array([6_378_137.0, 0.0, 0.0])


def _local(places: NDArray[np.float64], origin: NDArray[np.float64]) -> NDArray[np.float64]:
    """East, north, up in m (E, 3)."""
    latitude, longitude, _ = ecef_to_geodetic(origin)
    return (places - origin) @ enu_matrix(latitude, longitude).T


def _against(places: NDArray[np.float64], reference: NDArray[np.float64]) -> NDArray[np.float64]:
    """East, north, up of the difference (E, 3), by the axes of the first place known."""
    known = np.flatnonzero(np.isfinite(reference[:, 0]))
    first = reference[known[0]] if known.size else np.array([6_378_137.0, 0.0, 0.0])
    latitude, longitude, _ = ecef_to_geodetic(first)
    return (places - reference) @ enu_matrix(latitude, longitude).T


def _line(local: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    step = -(-len(local) // style.MOST_POINTS)
    return local[::step, 0], local[::step, 1]
