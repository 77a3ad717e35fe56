"""The key figure: phase difference above, its rate with threshold, onset and alarm below."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sdr_spoof import detectors
from sdr_spoof.detectors import DetectionConfig, StatisticSeries
from sdr_spoof.records import Alarm
from sdr_spoof.report.chart import Axis, Drawing, Entry, Grid, Panel, drawing
from sdr_spoof.report.chart.scale import Symlog
from sdr_spoof.report.evidence import broken, joined
from sdr_spoof.report.figures import style
from sdr_spoof.report.figures.overview import BOUND, BOUND_DASH, DOTTED, QUIET, QUIET_OPACITY
from sdr_spoof.report.figures.truth import TruthMark
from sdr_spoof.signals import signal_spec

Window = tuple[float, float]
"""Times between which a panel shows a series."""
ALL: Window = (-np.inf, np.inf)


def draw_difference(
    series: StatisticSeries,
    config: DetectionConfig,
    alarm: Alarm | None,
    truth: TruthMark | None = None,
) -> Drawing:
    """Whole recording on the left; with an alarm, a close-up of the onset on the right."""
    trace = _levelled(series, alarm)
    windows = [ALL] if alarm is None else [ALL, _near_onset(series, alarm, truth)]
    columns = [(_trace(series, trace, window), _rate(series, config, window)) for window in windows]
    for panel in (p for column in columns for p in column):
        _marks(panel, alarm, truth)
    _titles(*columns[0], series)
    if alarm is not None:
        _close_up(*columns[1], series, trace, windows[1])
    rows = list(zip(*columns, strict=True))
    grid = Grid(rows, [150.0, 150.0], widths=[1.7, 1.0][: len(columns)], share_x=True)
    return drawing(grid, legend=_legend(alarm, truth))


def _titles(top: Panel, bottom: Panel, series: StatisticSeries) -> None:
    scale = ", outer part of the axis logarithmic" if bottom.y.symlog is not None else ""
    if series.unit == "Hz":
        top.y.label = "Phase difference\n(cycles)"
        bottom.y.label = "Rate of the difference\n(Hz)"
        top.title = "Scaled carrier-phase difference, upper minus lower band"
        bottom.title = f"Its rate over {series.window_s:g} s{scale}"
        return
    of = f" of {signal_spec(series.signal).composite}" if series.signal else ""
    top.y.label = series.trace_unit.replace(", ", ",\n")
    bottom.y.label = f"Statistic\n({series.unit})"
    top.title = f"Measured{of}: {series.trace_unit}"
    title = detectors.find(series.detector).title
    bottom.title = f"{title} over {series.window_s:g} s{scale}"


def _levelled(series: StatisticSeries, alarm: Alarm | None) -> NDArray[np.float64]:
    """Trace from its level before the onset; NaN where it is not used."""
    values = joined(series)
    quiet = np.isfinite(values)
    if alarm is not None:
        quiet &= series.trace_time_s < alarm.onset_s
    return values - (np.median(values[quiet]) if quiet.any() else 0.0)


def _trace(series: StatisticSeries, trace: NDArray[np.float64], window: Window) -> Panel:
    shown = _inside(series.trace_time_s, window, series.window_s)
    panel = Panel()
    panel.line(series.trace_time_s[shown], trace[shown], style.INK, 1.2)
    return panel


def _rate(series: StatisticSeries, config: DetectionConfig, window: Window) -> Panel:
    threshold = series.threshold(config.false_alarm_probability)
    time, value, limit = broken(series, series.value, threshold)
    shown = _inside(time, window, series.window_s)
    panel = Panel(x=Axis("Time (s)"))
    edge_s, edge = style.thinned(time[shown], limit[shown])
    panel.area(edge_s, -edge, edge, QUIET, QUIET_OPACITY)
    for sign in (-1, 1):
        panel.line(edge_s, sign * edge, BOUND, 1.4, BOUND_DASH)
    panel.line(time[shown], value[shown], style.INK)
    peak = float(np.max(np.abs(series.value), initial=0.0))
    typical = float(np.median(threshold)) if threshold.size else 0.1
    if peak > 8 * typical:
        # Both the threshold and a drag far beyond it must be seen.
        panel.y.symlog = Symlog(2 * typical, 1.0)
        decades = 10.0 ** np.arange(np.ceil(np.log10(2 * typical)), np.ceil(np.log10(peak)) + 1)
        outer = [float(d) for d in decades if d <= peak] or [peak]
        inner = float(f"{typical:.1g}")
        panel.y.ticks = [*(-d for d in reversed(outer)), -inner, 0.0, inner, *outer]
        panel.y.names = [f"{t:.3g}".replace("-", "−") for t in panel.y.ticks]
    return panel


def _marks(panel: Panel, alarm: Alarm | None, truth: TruthMark | None) -> None:
    if alarm is not None:
        panel.moment(alarm.onset_s, style.ALARM, 2.2)
        panel.moment(alarm.alarm_s, style.ALARM, 1.8, DOTTED)
    for time_s, _, dash in truth.lines() if truth is not None else ():
        panel.moment(time_s, style.TRUTH, 1.8, dash)


def _legend(alarm: Alarm | None, truth: TruthMark | None) -> list[Entry]:
    found = [Entry("alarm threshold", BOUND, BOUND_DASH)]
    if alarm is not None:
        found += [
            Entry(f"found: onset {alarm.onset_s:.2f} s", style.ALARM),
            Entry(f"found: alarm {alarm.alarm_s:.2f} s", style.ALARM, DOTTED),
        ]
    lines = truth.lines() if truth is not None else []
    return found + [Entry(text, style.TRUTH, dash) for _, text, dash in lines]


def _near_onset(series: StatisticSeries, alarm: Alarm, truth: TruthMark | None) -> Window:
    start = alarm.onset_s - max(1.0, series.window_s)
    if truth is not None and truth.start_s > start - 2.0:
        start = min(start, truth.start_s - 0.2)
    return start, alarm.alarm_s + max(0.5, 0.5 * series.window_s)


def _inside(
    time_s: NDArray[np.float64], window: Window, beyond_s: float = 0.0
) -> NDArray[np.bool_]:
    """Rows in a window; lines are drawn somewhat beyond it, lest they end within the panel."""
    return np.asarray((time_s >= window[0] - beyond_s) & (time_s <= window[1] + beyond_s))


def _close_up(
    top: Panel,
    bottom: Panel,
    series: StatisticSeries,
    trace: NDArray[np.float64],
    window: Window,
) -> None:
    for panel in (top, bottom):
        panel.x.low, panel.x.high = window
    values = trace[_inside(series.trace_time_s, window) & (series.trace_segment >= 0)]
    if values.size:
        margin = 0.1 * float(np.ptp(values)) + 1e-3
        top.y.low, top.y.high = float(values.min()) - margin, float(values.max()) + margin
    top.title = "Close-up of the onset"
