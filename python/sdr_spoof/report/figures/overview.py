"""One look at an attack: every kind of evidence of one satellite on one time axis."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.chart import Axis, Drawing, Entry, Grid, Panel, drawing
from sdr_spoof.report.chart.marks import SOLID, Dash, Note
from sdr_spoof.report.chart.scale import Symlog
from sdr_spoof.report.evidence import Line
from sdr_spoof.report.figures import style, tracking_bar
from sdr_spoof.report.figures.case import Case
from sdr_spoof.report.figures.peaks import peak_panels, stretches
from sdr_spoof.signals import signal_spec

TEST_COLOURS = (style.INK, "#7b3294", "#00755a", "#8c6d1f", "#a6611a")
"""Of tests that compare the two signals, in the order of the configuration."""
SUSPICION = style.VERDICTS["suspect"]
LEAST_CYCLES = 0.1
"""An axis of a phase difference reaches so far at least: what is noise must look like it."""
BOUND, BOUND_DASH = "#00755a", (4, 2)
QUIET, QUIET_OPACITY = "#009e73", 0.13
"""What noise does."""
DASHED: Dash = (3, 1)
INNER_CYCLES = 0.25
"""Up to here the axis of a phase difference far beyond it is linear, then logarithmic."""
DOTTED: Dash = (2, 2)
Row = tuple[float, Panel]
"""Height of a panel, and the panel."""


def draw_overview(case: Case) -> Drawing:
    """Panels over time above, correlation peaks below."""
    rows = [
        (16.0 + 19.0 * len(case.tracks), tracking_bar.panel(case)),
        *_tests(case),
        (85.0, _cn0(case)),
        (60.0, _noise(case)),
    ]
    for _, panel in rows:
        _marks(panel, case)
    return drawing(_over_time(rows, case), _peaks(case), legend=_legend(case))


def draw_quiet(case: Case) -> Drawing | None:
    """A satellite without an alarm: what was tested, against its thresholds.

    None where nothing of that has been, as in a recording that was broken off early.
    """
    rows = _tests(case)
    return drawing(_over_time(rows, case), legend=_legend(case)) if rows else None


def _over_time(rows: Sequence[Row], case: Case) -> Grid:
    for _, panel in rows:
        panel.x.low, panel.x.high = 0.0, case.log.duration_s
    rows[-1][1].x.label = "Time (s)"
    return Grid([[panel] for _, panel in rows], [height for height, _ in rows], share_x=True)


def _tests(case: Case) -> list[Row]:
    found: list[Row] = []
    if case.evidence.difference.times_s:
        found.append((112.0, _difference(case)))
    if case.evidence.consistency:
        found.append((100.0, _consistency(case)))
    for name, title in (("delta_metric", "Delta"), ("ratio_metric", "Ratio")):
        if any(of == name for of, _ in case.evidence.quality):
            found.append((64.0, _quality(case, name, title)))
    return found


def _difference(case: Case) -> Panel:
    time_s, value = case.evidence.difference.joined()
    before = value[(time_s < case.onset_s) & np.isfinite(value)]
    value = value - (float(np.median(before)) if before.size else 0.0)
    panel = Panel(y=Axis("Phase difference\n(cycles)"))
    panel.line(time_s, value, style.INK, 1.3)
    low, high = float(np.nanmin(value, initial=0.0)), float(np.nanmax(value, initial=0.0))
    size = max(-low, high)
    if size < LEAST_CYCLES:
        panel.y.low, panel.y.high = -LEAST_CYCLES, LEAST_CYCLES
    elif size > 8 * INNER_CYCLES:  # the first disturbance must be seen too
        panel.y.symlog = Symlog(INNER_CYCLES, 0.9)
        ticks = [t for t in (INNER_CYCLES, 1, 10, 100, 1000) if t < 1.2 * size]
        panel.y.ticks = [
            *(-t for t in reversed(ticks) if -t > 1.2 * low),
            0,
            *(t for t in ticks if t < 1.2 * high),
        ]
        panel.y.names = [f"{t:g}".replace("-", "−") for t in panel.y.ticks]
        panel.y.low, panel.y.high = 1.3 * low - 0.05, 1.3 * high + 0.05
        _say_logarithmic(panel, rises=bool(np.nanmean(value) > 0.0))
    return panel


def _say_logarithmic(panel: Panel, *, rises: bool) -> None:
    """In the corner that the line stays out of."""
    text = f"logarithmic beyond ±{INNER_CYCLES:g}"
    at = 0.06 if rises else 0.9
    panel.note(Note(0.995, at, text, style.MUTED, anchor="end", inside=True))


def _consistency(case: Case) -> Panel:
    panel = Panel(y=Axis("|Test| /\nthreshold", symlog=Symlog(1.0, 0.78)))
    panel.shade(QUIET, QUIET_OPACITY, y=(0.0, 1.0))
    peak, compared = 1.0, 0
    for line in case.evidence.consistency.values():
        if line.signal is None:
            colour, dash = TEST_COLOURS[compared % len(TEST_COLOURS)], SOLID
            compared += 1
        else:
            colour, dash = style.colour(line.signal), DASHED
        time_s, value = line.joined()
        panel.line(time_s, value, colour, dash=dash)
        panel.entries.append(Entry(_name(line), colour, dash))
        peak = max(peak, float(np.nanmax(value, initial=0.0)))
    panel.level(1.0, BOUND, dash=BOUND_DASH)
    top = max(1.6 * peak, 2.0)
    panel.y.low, panel.y.high = 0.0, top
    panel.y.ticks = [0, *(t for t in (1, 10, 100, 1000) if t < top)]
    return panel


def _name(line: Line) -> str:
    """A test as the configuration names it, and its signal."""
    of = f" {signal_spec(line.signal).composite}" if line.signal else ""
    return line.label.replace("_", " ") + of


def _quality(case: Case, name: str, title: str) -> Panel:
    panel = Panel(y=Axis(f"{title} /\nbound"))
    panel.shade(QUIET, QUIET_OPACITY, y=(-1.0, 1.0))
    peak = 1.0
    for (of, signal), line in case.evidence.quality.items():
        if of == name and signal is not None:
            time_s, value = line.joined()
            panel.line(time_s, value, style.colour(signal), 1.4)
            peak = max(peak, float(np.nanmax(np.abs(value), initial=0.0)))
    for bound in (-1.0, 1.0):
        panel.level(bound, BOUND, dash=BOUND_DASH)
    panel.y.low, panel.y.high = -1.25 * peak, 1.25 * peak
    return panel


def _held(track: SignalTrack, values: np.ndarray) -> np.ndarray:
    return np.where(track.state >= State.TRACKING, values, np.nan)


def _cn0(case: Case) -> Panel:
    panel = Panel(y=Axis("C/N0\n(dB-Hz)"))
    for track in case.tracks:
        panel.line(track.time_s, _held(track, track.cn0_dbhz), style.colour(track.signal))
    return panel


def _noise(case: Case) -> Panel:
    """Noise power of each band over its median before the onset; no less than +-1 dB is shown."""
    panel, size = Panel(y=Axis("Noise power\n(dB)")), 1.0
    for track in case.tracks:
        known = (track.noise_power > 0.0) & (track.state >= State.TRACKING)
        before = track.noise_power[known & (track.time_s < case.onset_s)]
        if not before.size:
            continue
        power = np.where(known, track.noise_power, np.nan) / np.median(before)
        value = 10.0 * np.log10(power)
        panel.line(track.time_s, _held(track, value), style.colour(track.signal))
        size = max(size, float(np.nanmax(np.abs(value), initial=0.0)))
    panel.y.low, panel.y.high = -1.1 * size, 1.1 * size
    return panel


def _marks(panel: Panel, case: Case) -> None:
    panel.moment(case.onset_s, case.colour, 2.2)
    panel.moment(case.alarm_s, case.colour, 1.8, DOTTED)
    if case.suspicion_s is not None:
        panel.moment(case.suspicion_s, SUSPICION, 1.8, DOTTED)
    for time_s, _, dash in case.truth.lines() if case.truth is not None else ():
        panel.moment(time_s, style.TRUTH, 1.5, dash)


def _legend(case: Case) -> list[Entry]:
    entries = [Entry(signal_spec(t.signal).composite, style.colour(t.signal)) for t in case.tracks]
    if case.satellite.alarms:
        entries += [
            Entry(f"found: onset {case.onset_s:.2f} s", case.colour),
            Entry(f"found: alarm {case.alarm_s:.2f} s", case.colour, DOTTED),
        ]
    if case.suspicion_s is not None:
        entries.append(Entry(f"first suspicion {case.suspicion_s:.2f} s", SUSPICION, DOTTED))
    for _, text, dash in case.truth.lines() if case.truth is not None else ():
        entries.append(Entry(text, style.TRUTH, dash))
    return entries


def _peaks(case: Case) -> Grid:
    last_s = max(a.alarm_s for a in case.satellite.alarms)
    parts = stretches(case.onset_s, last_s, case.log.duration_s)
    panels = [
        panel
        for track in case.whole
        for panel in peak_panels(track, parts, captured=track.signal == case.satellite.band)
    ]
    reach = max(abs(v) for p in panels for v in p.reach(0) if np.isfinite(v)) if panels else 0.5
    for panel in panels:
        panel.x.low, panel.x.high = -max(1.05 * reach, 0.55), max(1.05 * reach, 0.55)
    panels[0].y.label = "Correlation peak\n(before = 1)"
    caption = "Tap delay (chips, positive = late); grey: before"
    return Grid([panels], [105.0], share_y=True, caption=caption)
