"""Where satellites and stations stand in the sky, coloured by what was said of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.projections.polar import PolarAxes
    from numpy.typing import NDArray

COLOURS = {**style.VERDICTS, "clean": "#00694f", "unsupported": style.MUTED, "station": "#0072b2"}
LABELS = {
    "spoofed": "spoofed",
    "suspect": "suspect",
    "clean": "no alarm",
    "unsupported": "not tested",
    "station": "DME station",
}


@dataclass(frozen=True)
class Look:
    """One transmitter."""

    name: str
    unit: NDArray[np.float64]
    """Towards it over time: east, north, up, (K, 3); NaN where it was not seen."""
    level: str
    """A key of :data:`COLOURS`."""


def azimuth_elevation_deg(unit: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of unit vectors east, north, up (..., 3), in degrees (..., 2)."""
    east, north, up = np.moveaxis(unit, -1, 0)
    azimuth = np.degrees(np.arctan2(east, north)) % 360.0
    return np.stack([azimuth, np.degrees(np.arcsin(np.clip(up, -1.0, 1.0)))], axis=-1)


def draw_looks(axes: PolarAxes, looks: Sequence[Look]) -> None:
    """Azimuth and elevation: a line where it went, a dot where it stood last, and its name."""
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    axes.set_ylim(0, 90)
    axes.set_yticks([30, 60, 90], ["60°", "30°", ""])
    axes.set_xticks(np.radians(np.arange(0, 360, 90)), ["N", "E", "S", "W"])
    axes.set_rlabel_position(_free_deg(looks))
    for look in looks:
        _draw(axes, look)
    for level in dict.fromkeys(look.level for look in looks):
        marker = "^" if level == "station" else "o"
        axes.plot([], [], marker, color=COLOURS[level], label=LABELS[level])
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=3)


def _free_deg(looks: Sequence[Look]) -> float:
    """Azimuth of the circles' labels, away from all transmitters."""
    places = np.concatenate([np.zeros((0, 2)), *(azimuth_elevation_deg(k.unit) for k in looks)])
    taken = np.radians(places[np.isfinite(places).all(axis=1), 0])
    free = np.arange(20.0, 360.0, 30.0)
    nearest = np.cos(np.radians(free)[:, None] - taken).max(axis=1, initial=-1.0)
    return float(free[nearest.argmin()])


def _draw(axes: PolarAxes, look: Look) -> None:
    place = azimuth_elevation_deg(look.unit[np.isfinite(look.unit).all(axis=1)])
    if not place.size:
        return
    theta, radius = np.radians(place[:, 0]), 90.0 - np.clip(place[:, 1], 0.0, 90.0)
    colour, station = COLOURS[look.level], look.level == "station"
    axes.plot(theta, radius, color=colour, lw=2, alpha=0.5, solid_capstyle="round")
    marker = "^" if station else "o"
    axes.plot(theta[-1:], radius[-1:], marker, color=colour, ms=8, clip_on=False)
    axes.annotate(
        look.name,
        (theta[-1], radius[-1]),
        xytext=(7, -13 if station else 5),
        textcoords="offset points",
        fontsize=8.5,
        fontweight="bold",
        color=colour if look.level == "spoofed" else style.INK,
    )
