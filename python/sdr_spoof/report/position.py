"""What the report says of positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.positioning.summary import sentences, summarise
from sdr_spoof.report.figures.position import draw_geometry, draw_track
from sdr_spoof.report.figures.sky_plot import draw_sky

if TYPE_CHECKING:
    from sdr_spoof.positioning import Located

COLOURS = "Green: no alarm; amber: a satellite under suspicion; red: spoofed satellites left out."


@dataclass(frozen=True)
class PositionPart:
    """Sentences and figures; no figures without a position."""

    sentences: tuple[str, ...]
    notes: tuple[str, ...] = ()
    figures: tuple[tuple[str, str], ...] = ()
    """(what it shows and how, picture)."""


def draw_position(located: Located | None, why_not: str) -> PositionPart | None:
    """The part on positions; None where nothing was tried."""
    if located is None:
        return PositionPart((f"No position: {why_not}",)) if why_not else None
    summary = summarise(located)
    told = tuple(sentences(summary))
    if not summary.fixes:
        return PositionPart(told, summary.notes)
    route = located.route
    figures = (
        (f"Satellites in the sky, as seen from the receiver. {COLOURS}", draw_sky(route)),
        (f"Track, and scatter of the fixes. {COLOURS}", draw_track(route)),
        (
            f"Height, geometry and residuals over time. Dots of the height: {COLOURS.lower()}",
            draw_geometry(route),
        ),
    )
    return PositionPart(told, summary.notes, figures)
