"""Where the satellites stood, seen from the receiver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.report.chart import Drawing, Entry, svg
from sdr_spoof.report.chart.picture import fine, key, symbol
from sdr_spoof.route import ALARM_COLOURS, Alarm

from . import style

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.route import Route, SatelliteView

LABELS = {
    Alarm.NONE: "no alarm",
    Alarm.SUSPECT: "suspect",
    Alarm.SPOOFED: "spoofed",
}
RADIUS, MIDDLE = 200.0, (430.0, 230.0)
"""Of the horizon, in units of a picture 1000 wide."""
BESIDE = ((25.0, 0.0), (-25.0, 0.0), (0.0, -16.0), (0.0, 16.0))
"""Where the middle of a name may lie, from its dot."""
WINDS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


def draw_sky(route: Route) -> Drawing:
    """Azimuth and elevation of each satellite over the recording, coloured by what was said of it.

    A dot is where it stood last; hollow where the last fix did not use it.
    """
    entries = [Entry(LABELS[a], ALARM_COLOURS[a], shape="dot") for a in Alarm]
    entries.append(Entry("not used at the end", style.MUTED, shape="ring"))
    courses = [course for s in route.satellites if (course := _Course.of(s)) is not None]
    content = _sky() + "".join(course.svg() for course in courses) + _names(courses)
    content += key(entries, 730.0, 1.0, 380.0)[0]  # one below the other
    return Drawing(content, 1000.0, 2.0 * MIDDLE[1])


def _place(azimuth_deg: float, radius: float) -> tuple[float, float]:
    """North is up, east to the right; a radius of 1 is the horizon."""
    turn = np.radians(azimuth_deg)
    sine, cosine = float(np.sin(turn)), float(np.cos(turn))
    return MIDDLE[0] + RADIUS * radius * sine, MIDDLE[1] - RADIUS * radius * cosine


def _sky() -> str:
    """Circles of elevation, and the winds."""
    content = ""
    for elevation_deg in (0, 30, 60):
        share = 1.0 - elevation_deg / 90.0
        colour = "#b8c0c8" if elevation_deg == 0 else style.GRID
        content += svg.element(
            "circle", cx=MIDDLE[0], cy=MIDDLE[1], r=RADIUS * share, fill="none", stroke=colour
        )
        if elevation_deg:
            x, y = _place(22.5, share)
            content += _small(x, y, f"{elevation_deg}°", "start")
    for number, wind in enumerate(WINDS):
        (x, y), (end_x, end_y) = _place(45.0 * number, 1.0), _place(45.0 * number, 1.07)
        data = f"M{MIDDLE[0]:g} {MIDDLE[1]:g}L{x:.1f} {y:.1f}"
        content += svg.element("path", d=data, stroke=style.GRID)
        content += _small(end_x, end_y + 4.0, wind, "middle")
    return content


def _small(x: float, y: float, words: str, anchor: str) -> str:
    return svg.text(x, y, words, font_size=11.5, fill=style.MUTED, text_anchor=anchor)


@dataclass(frozen=True)
class _Course:
    """A satellite's way across the picture."""

    name: str
    colour: str
    used: bool
    x: NDArray[np.float64]
    y: NDArray[np.float64]

    @classmethod
    def of(cls, satellite: SatelliteView) -> _Course | None:
        """None if it was never seen above the horizon."""
        up = np.isfinite(satellite.elevation_deg) & (satellite.elevation_deg >= 0)
        seen = np.flatnonzero(up)
        if not seen.size:
            return None
        turn = np.radians(satellite.azimuth_deg[seen])
        radius = RADIUS * (1.0 - satellite.elevation_deg[seen] / 90.0)
        x, y = MIDDLE[0] + radius * np.sin(turn), MIDDLE[1] - radius * np.cos(turn)
        colour = ALARM_COLOURS[Alarm(int(satellite.alarm[seen].max()))]
        return cls(satellite.name, colour, bool(satellite.used[seen[-1]]), x, y)

    @property
    def end(self) -> tuple[float, float]:
        """Where it stood last."""
        return float(self.x[-1]), float(self.y[-1])

    def svg(self) -> str:
        """Line and dot."""
        line = svg.element(
            "path",
            d=svg.path(self.x, self.y),
            fill="none",
            opacity=0.5,
            stroke=self.colour,
            stroke_width=svg.FINE * 2.8,
            stroke_linecap="round",
        )
        return fine(line) + symbol(*self.end, self.colour, "dot" if self.used else "ring", 6.0)


def _names(courses: list[_Course]) -> str:
    """Names beside the dots, each where it lies over the fewest dots and names."""
    taken = [course.end for course in courses]
    content = ""
    for course in courses:
        x, y = course.end
        places = [(x + dx, y + dy) for dx, dy in BESIDE]
        at_x, at_y = min(places, key=lambda p: sum(_over(p, other) for other in taken))
        taken.append((at_x, at_y))
        content += svg.text(at_x, at_y + 4.5, course.name, font_weight="bold", text_anchor="middle")
    return content


def _over(place: tuple[float, float], other: tuple[float, float]) -> bool:
    return abs(place[0] - other[0]) < 24.0 and abs(place[1] - other[1]) < 13.0
