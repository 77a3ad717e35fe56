"""Panels of the evidence of one satellite: phase difference, tests of consistency, peak shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.signals import signal_spec

from . import style
from .panels import Entry, Look, Note, Panel, Stroke
from .style import SOLID, Dash

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sdr_spoof.report.evidence import Evidence, Line

TEST_COLOURS = (style.INK, "#7b3294", "#00755a", "#8c6d1f", "#a6611a")
"""Of tests that compare the two signals, in the order of the configuration."""
DASHED: Dash = (0, (3, 1))
LEAST_CYCLES = 0.1
"""An axis of a phase difference reaches so far at least: what is noise must look like it."""
INNER_CYCLES = 0.25
"""Up to here the axis of a phase difference far beyond it is linear, then logarithmic."""
DECADES = (1, 10, 100, 1000)
MOST_COLUMNS = 6
"""Of a legend."""


def evidence_panels(evidence: Evidence, onset_s: float) -> Iterator[Panel]:
    """What there is, from top to bottom; levels are those before ``onset_s``."""
    if evidence.difference.times_s:
        yield _difference(evidence.difference, onset_s)
    if evidence.consistency:
        yield _consistency(list(evidence.consistency.values()))
    for name, title in (("delta_metric", "Delta"), ("ratio_metric", "Ratio")):
        lines = [line for (of, _), line in evidence.quality.items() if of == name]
        if lines:
            yield _quality(lines, title)


def _difference(line: Line, onset_s: float) -> Panel:
    time_s, value = line.joined()
    known = np.isfinite(value)
    before = value[(time_s < onset_s) & known]
    value = value - (float(np.median(before)) if before.size else 0.0)
    stroke = (Stroke(*style.thinned(time_s, value), style.INK, width=1.0),)
    label, height_in = "Phase difference\n(cycles)", 1.45
    size = float(np.abs(value[known]).max(initial=0.0))
    if size <= 8 * INNER_CYCLES:
        limits = (-LEAST_CYCLES, LEAST_CYCLES) if size < LEAST_CYCLES else None
        return Panel(Look(label, height_in), stroke, limits)
    # The first disturbance must be seen too.
    ticks = [t for t in (INNER_CYCLES, *DECADES) if t < 1.2 * size]
    low, high = float(np.nanmin(value)), float(np.nanmax(value))
    negative = [-t for t in reversed(ticks) if -t > 1.2 * low]
    positive = [t for t in ticks if t < 1.2 * high]
    rises = bool(np.nanmean(value) > 0.0)  # to the upper right: the note goes below
    note = Note(f"logarithmic beyond ±{INNER_CYCLES:g}", below=rises)
    look = Look(label, height_in, symlog=(INNER_CYCLES, 0.8), note=note)
    return Panel(look, stroke, ticks=(*negative, 0, *positive))


def _consistency(lines: Sequence[Line]) -> Panel:
    strokes, entries = [], []
    peak, compared = 1.0, 0
    for line in lines:
        if line.signal is None:
            entry = Entry(_name(line), TEST_COLOURS[compared % len(TEST_COLOURS)], SOLID)
            compared += 1
        else:
            entry = Entry(_name(line), style.colour(line.signal), DASHED)
        time_s, value = style.thinned(*line.joined())
        strokes.append(Stroke(time_s, value, entry.colour, entry.dash))
        entries.append(entry)
        peak = max(peak, float(np.nanmax(value, initial=0.0)))
    look = Look(
        "|Test| /\nthreshold",
        1.35,
        quiet=(0, 1),
        bounds=(1,),
        symlog=(1.0, 0.7),
        legend=tuple(entries),
        columns=min(len(entries), MOST_COLUMNS),
    )
    top = max(1.6 * peak, 2.0)
    return Panel(look, tuple(strokes), (0, top), (0, *(t for t in DECADES if t < top)))


def _name(line: Line) -> str:
    """A test as the configuration names it, and its signal."""
    of = f" {signal_spec(line.signal).composite}" if line.signal else ""
    return line.label.replace("_", " ") + of


def _quality(lines: Sequence[Line], title: str) -> Panel:
    strokes, peak = [], 1.0
    for line in lines:
        if line.signal is not None:
            time_s, value = style.thinned(*line.joined())
            strokes.append(Stroke(time_s, value, style.colour(line.signal), width=1.1))
            peak = max(peak, float(np.nanmax(np.abs(value), initial=0.0)))
    look = Look(f"{title} /\nbound", 0.85, quiet=(-1, 1), bounds=(-1, 1))
    return Panel(look, tuple(strokes), (-1.25 * peak, 1.25 * peak))
