"""The key figure: phase difference above, its rate with threshold, onset and alarm below."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator
from numpy.typing import NDArray

from sdr_spoof import detectors
from sdr_spoof.detectors import DetectionConfig, StatisticSeries
from sdr_spoof.records import Alarm
from sdr_spoof.report.evidence import broken, joined
from sdr_spoof.report.figures import style
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
) -> str:
    """Whole recording on the left; with an alarm, a close-up of the onset on the right."""

    def draw(figure: Figure) -> None:
        if alarm is None:
            panels = figure.subplots(2, 1, sharex=True, squeeze=False)
        else:
            panels = figure.subplots(
                2, 2, sharex="col", gridspec_kw={"width_ratios": [1.7, 1]}, squeeze=False
            )
        trace = _levelled(series, alarm)
        windows = [ALL] if alarm is None else [ALL, _near_onset(series, alarm, truth)]
        for column, window in zip(panels.T, windows, strict=True):
            _trace(column[0], series, trace, window)
            _rate(column[1], series, config, window)
            for axes in column:
                _marks(axes, alarm, truth)
        _titles(panels[0, 0], panels[1, 0], series)
        if alarm is not None:
            _close_up(panels[0, 1], panels[1, 1], series, trace, windows[1])
        _legend(figure, panels[1, 0], alarm, truth)

    return style.render(draw, 10.0, 4.8)


def _titles(top: Axes, bottom: Axes, series: StatisticSeries) -> None:
    scale = ", outer part of the axis logarithmic" * (bottom.get_yscale() == "symlog")
    if series.unit == "Hz":
        top.set_ylabel("Phase difference\n(cycles)")
        bottom.set_ylabel("Rate of the difference\n(Hz)")
        top.set_title("Scaled carrier-phase difference, upper minus lower band")
        bottom.set_title(f"Its rate over {series.window_s:g} s{scale}")
        return
    of = f" of {signal_spec(series.signal).composite}" if series.signal else ""
    top.set_ylabel(series.trace_unit.replace(", ", ",\n"))
    bottom.set_ylabel(f"Statistic\n({series.unit})")
    top.set_title(f"Measured{of}: {series.trace_unit}")
    title = detectors.find(series.detector).title
    bottom.set_title(f"{title} over {series.window_s:g} s{scale}")


def _levelled(series: StatisticSeries, alarm: Alarm | None) -> NDArray[np.float64]:
    """Trace from its level before the onset; NaN where it is not used."""
    values = joined(series)
    quiet = np.isfinite(values)
    if alarm is not None:
        quiet &= series.trace_time_s < alarm.onset_s
    return values - (np.median(values[quiet]) if quiet.any() else 0.0)


def _trace(axes: Axes, series: StatisticSeries, trace: NDArray[np.float64], window: Window) -> None:
    shown = _inside(series.trace_time_s, window, series.window_s)
    line = style.thinned(series.trace_time_s[shown], trace[shown])
    axes.plot(*line, color=style.INK, linewidth=0.9)


def _rate(axes: Axes, series: StatisticSeries, config: DetectionConfig, window: Window) -> None:
    threshold = series.threshold(config.false_alarm_probability)
    time, value, limit = broken(series, series.value, threshold)
    shown = _inside(time, window, series.window_s)
    limit_time, edge = style.thinned(time[shown], limit[shown])
    axes.fill_between(limit_time, -edge, edge, color="#009e73", alpha=0.13, linewidth=0)
    for sign in (-1, 1):
        axes.plot(limit_time, sign * edge, color="#00755a", linewidth=1.0, linestyle=(0, (4, 2)))
    axes.plot(*style.thinned(time[shown], value[shown]), color=style.INK, linewidth=1.2)
    peak = float(np.max(np.abs(series.value), initial=0.0))
    typical = float(np.median(threshold)) if threshold.size else 0.1
    if peak > 8 * typical:
        # Both the threshold and a drag far beyond it must be seen.
        axes.set_yscale("symlog", linthresh=2 * typical, linscale=0.9)
        decades = 10.0 ** np.arange(np.ceil(np.log10(2 * typical)), np.ceil(np.log10(peak)) + 1)
        outer = [d for d in decades if d <= 1.5 * peak] or [peak]
        inner = float(f"{typical:.1g}")
        axes.set_yticks([*(-d for d in reversed(outer)), -inner, 0, inner, *outer])
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axes.set_xlabel("Time (s)")


def _marks(axes: Axes, alarm: Alarm | None, truth: TruthMark | None) -> None:
    if alarm is not None:
        axes.axvline(alarm.onset_s, color=style.ALARM, linewidth=1.6)
        axes.axvline(alarm.alarm_s, color=style.ALARM, linewidth=1.3, linestyle=(0, (2, 2)))
    for time_s, _, dash in truth.lines() if truth is not None else ():
        axes.axvline(time_s, color=style.TRUTH, linewidth=1.3, linestyle=dash)


def _legend(figure: Figure, axes: Axes, alarm: Alarm | None, truth: TruthMark | None) -> None:
    found = [(axes.get_lines()[0], "alarm threshold")]
    if alarm is not None:
        found += [
            (style.sample(style.ALARM, width=1.5), f"found: onset {alarm.onset_s:.2f} s"),
            (style.sample(style.ALARM, (0, (2, 2)), 1.5), f"found: alarm {alarm.alarm_s:.2f} s"),
        ]
    lines = truth.lines() if truth is not None else []
    true = [(style.sample(style.TRUTH, dash, 1.5), text) for _, text, dash in lines]
    if len(found) == len(true):  # columns are filled first: what was found above the truth
        found = [entry for pair in zip(found, true, strict=True) for entry in pair]
    else:
        found += true
    figure.legend(*zip(*found, strict=True), loc="outside lower center", ncols=3)


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
    top: Axes,
    bottom: Axes,
    series: StatisticSeries,
    trace: NDArray[np.float64],
    window: Window,
) -> None:
    bottom.set_xlim(*window)
    values = trace[_inside(series.trace_time_s, window) & (series.trace_segment >= 0)]
    if values.size:
        margin = 0.1 * float(np.ptp(values)) + 1e-3
        top.set_ylim(float(values.min()) - margin, float(values.max()) + margin)
    top.set_title("Close-up of the onset")
