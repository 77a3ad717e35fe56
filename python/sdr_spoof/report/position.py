"""What the report says of positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.positioning.summary import sentences, summarise

if TYPE_CHECKING:
    from sdr_spoof.positioning import Located

    from .crew import Picture
    from .pictures import Pictures

COLOURS = "Green: no alarm; amber: a satellite under suspicion; red: spoofed satellites left out."


@dataclass(frozen=True)
class PositionPart:
    """Sentences and figures; no figures without a position."""

    sentences: tuple[str, ...]
    notes: tuple[str, ...] = ()
    figures: tuple[tuple[str, Picture], ...] = ()
    """(what it shows and how, picture)."""


def position_part(located: Located | None, why_not: str, pictures: Pictures) -> PositionPart | None:
    """The part on positions; None where nothing was tried."""
    if located is None:
        return PositionPart((f"No position: {why_not}",)) if why_not else None
    summary = summarise(located)
    told = tuple(sentences(summary))
    if not summary.fixes:
        return PositionPart(told, summary.notes)
    captions = (
        f"Satellites in the sky, as seen from the receiver. {COLOURS}",
        f"Track, and scatter of the fixes. {COLOURS}",
        f"Height, geometry and residuals over time. Dots of the height: {COLOURS.lower()}",
    )
    figures = tuple(zip(captions, pictures.located(located.route), strict=True))
    return PositionPart(told, summary.notes, figures)
