"""One look at an attack: every kind of evidence of one satellite on one time axis."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullLocator

from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.evidence import Line
from sdr_spoof.report.figures import style, tracking_bar
from sdr_spoof.report.figures.case import Case
from sdr_spoof.report.figures.peaks import draw_peaks, stretches
from sdr_spoof.signals import signal_spec

TEST_COLOURS = (style.INK, "#7b3294", "#00755a", "#8c6d1f", "#a6611a")
"""Of tests that compare the two signals, in the order of the configuration."""
SUSPICION = style.VERDICTS["suspect"]
LEAST_CYCLES = 0.1
"""An axis of a phase difference reaches so far at least: what is noise must look like it."""
INNER_CYCLES = 0.25
"""Up to here the axis of a phase difference far beyond it is linear, then logarithmic."""
QUIET: dict[str, Any] = {"color": "#009e73", "alpha": 0.13, "linewidth": 0}


Dash = tuple[int, tuple[int, ...]]
Place = Literal["upper center", "outside upper center"]
SOLID: Dash = (0, ())
DASHED: Dash = (0, (3, 1))
DOTTED: Dash = (0, (2, 2))
Panel = tuple[float, Callable[[Axes, Case], None]]


def draw_overview(case: Case) -> str:
    """Panels over time above, correlation peaks below."""
    panels = list(_panels(case))
    bands = max(len(case.tracks), 1)
    heights = [sum(h for h, _ in panels), 1.75]

    def draw(figure: Figure) -> None:
        top, bottom = figure.subfigures(2, 1, height_ratios=heights, squeeze=False)[:, 0]
        axes = top.subplots(
            len(panels), 1, sharex=True, height_ratios=[h for h, _ in panels], squeeze=False
        )[:, 0]
        for one, (_, fill) in zip(axes, panels, strict=True):
            fill(one, case)
            _marks(one, case)
        axes[-1].set_xlim(0, case.log.duration_s)
        axes[-1].set_xlabel("Time (s)")
        top.align_ylabels(list(axes))
        _legend(top, case)
        _peaks(bottom, case, bands)

    return style.render(draw, 10.0, sum(heights) + 0.9)


def draw_quiet(case: Case) -> str | None:
    """A satellite without an alarm: what was tested, against its thresholds.

    None where nothing of that has been, as in a recording that was broken off early.
    """
    panels = [p for p in _panels(case) if p[1] not in (tracking_bar.draw, _cn0, _noise)]
    if not panels:
        return None
    height = sum(h for h, _ in panels) + 0.9

    def draw(figure: Figure) -> None:
        places = {
            **{"left": 0.085, "right": 0.992, "hspace": 0.32},
            **{"bottom": 0.48 / height, "top": 1 - 0.58 / height},
        }
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False, gridspec_kw=places)[:, 0]
        for one, (_, fill) in zip(axes, panels, strict=True):
            fill(one, case)
            one.yaxis.set_label_coords(-0.055, 0.5)
        axes[-1].set_xlim(0, case.log.duration_s)
        axes[-1].set_xlabel("Time (s)")
        _legend(figure, case, "upper center")

    return style.render(draw, 10.0, height, placed=True)


def _panels(case: Case) -> list[Panel]:
    found: list[Panel] = [(0.35 + 0.2 * len(case.tracks), tracking_bar.draw)]
    if case.evidence.difference.times_s:
        found.append((1.45, _difference))
    if case.evidence.consistency:
        found.append((1.35, _consistency))
    for name, title in (("delta_metric", "Delta"), ("ratio_metric", "Ratio")):
        if any(of == name for of, _ in case.evidence.quality):
            found.append((0.85, _quality_panel(name, title)))
    return [*found, (1.1, _cn0), (0.75, _noise)]


def _difference(axes: Axes, case: Case) -> None:
    time_s, value = case.evidence.difference.joined()
    before = value[(time_s < case.onset_s) & np.isfinite(value)]
    level = float(np.median(before)) if before.size else 0.0
    axes.plot(*style.thinned(time_s, value - level), color=style.INK, linewidth=1.0)
    axes.set_ylabel("Phase difference\n(cycles)")
    size = np.abs(value[np.isfinite(value)] - level)
    if size.max(initial=0.0) < LEAST_CYCLES:
        axes.set_ylim(-LEAST_CYCLES, LEAST_CYCLES)
    elif size.max() > 8 * INNER_CYCLES:  # the first disturbance must be seen too
        axes.set_yscale("symlog", linthresh=INNER_CYCLES, linscale=0.8)
        ticks = [t for t in (INNER_CYCLES, 1, 10, 100, 1000) if t < 1.2 * size.max()]
        low, high = np.nanmin(value - level), np.nanmax(value - level)
        signed = [-t for t in reversed(ticks) if -t > 1.2 * low]
        axes.set_yticks([*signed, 0, *(t for t in ticks if t < 1.2 * high)])
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
        rises = bool(np.nanmean(value - level) > 0.0)  # to the upper right: the note goes below
        axes.text(
            0.995,
            0.04 if rises else 0.96,
            f"logarithmic beyond ±{INNER_CYCLES:g}",
            transform=axes.transAxes,
            fontsize=8,
            color=style.MUTED,
            ha="right",
            va="bottom" if rises else "top",
        )


def _consistency(axes: Axes, case: Case) -> None:
    axes.axhspan(0, 1, **QUIET)
    axes.axhline(1, color="#00755a", linewidth=1.0, linestyle=(0, (4, 2)))
    peak, compared = 1.0, 0
    for line in case.evidence.consistency.values():
        if line.signal is None:
            colour, dash = TEST_COLOURS[compared % len(TEST_COLOURS)], SOLID
            compared += 1
        else:
            colour, dash = style.colour(line.signal), DASHED
        time_s, value = style.thinned(*line.joined())
        axes.plot(time_s, value, color=colour, linestyle=dash, linewidth=1.2, label=_name(line))
        peak = max(peak, float(np.nanmax(value, initial=0.0)))
    axes.set_yscale("symlog", linthresh=1.0, linscale=0.7)
    top = max(1.6 * peak, 2.0)
    axes.set_ylim(0, top)
    axes.set_yticks([0, *(t for t in (1, 10, 100, 1000) if t < top)])
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axes.set_ylabel("|Test| /\nthreshold")
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 0.98),
        borderaxespad=0.0,
        fontsize=8,
        ncols=max(compared + len(case.tracks), 1),
        handlelength=1.6,
        columnspacing=1.4,
    )


def _name(line: Line) -> str:
    """A test as the configuration names it, and its signal."""
    of = f" {signal_spec(line.signal).composite}" if line.signal else ""
    return line.label.replace("_", " ") + of


def _quality_panel(name: str, title: str) -> Callable[[Axes, Case], None]:
    def draw(axes: Axes, case: Case) -> None:
        axes.axhspan(-1, 1, **QUIET)
        for sign in (-1, 1):
            axes.axhline(sign, color="#00755a", linewidth=1.0, linestyle=(0, (4, 2)))
        peak = 1.0
        for (of, signal), line in case.evidence.quality.items():
            if of == name and signal is not None:
                time_s, value = style.thinned(*line.joined())
                axes.plot(time_s, value, color=style.colour(signal), linewidth=1.1)
                peak = max(peak, float(np.nanmax(np.abs(value), initial=0.0)))
        axes.set_ylim(-1.25 * peak, 1.25 * peak)
        axes.set_ylabel(f"{title} /\nbound")

    return draw


def _held(track: SignalTrack, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return style.thinned(track.time_s, np.where(track.state >= State.TRACKING, values, np.nan))


def _cn0(axes: Axes, case: Case) -> None:
    for track in case.tracks:
        axes.plot(*_held(track, track.cn0_dbhz), color=style.colour(track.signal), linewidth=1.2)
    axes.set_ylabel("C/N0\n(dB-Hz)")


def _noise(axes: Axes, case: Case) -> None:
    """Noise power of each band over its median before the onset; no less than +-1 dB is shown."""
    size = 1.0
    for track in case.tracks:
        known = (track.noise_power > 0.0) & (track.state >= State.TRACKING)
        before = track.noise_power[known & (track.time_s < case.onset_s)]
        if not before.size:
            continue
        power = np.where(known, track.noise_power, np.nan) / np.median(before)
        value = 10.0 * np.log10(power)
        axes.plot(*_held(track, value), color=style.colour(track.signal), linewidth=1.2)
        size = max(size, float(np.nanmax(np.abs(value), initial=0.0)))
    axes.set_ylim(-1.1 * size, 1.1 * size)
    axes.set_ylabel("Noise power\n(dB)")


def _marks(axes: Axes, case: Case) -> None:
    axes.axvline(case.onset_s, color=case.colour, linewidth=1.6)
    axes.axvline(case.alarm_s, color=case.colour, linewidth=1.3, linestyle=DOTTED)
    if case.suspicion_s is not None:
        axes.axvline(case.suspicion_s, color=SUSPICION, linewidth=1.3, linestyle=DOTTED)
    for time_s, _, dash in case.truth.lines() if case.truth is not None else ():
        axes.axvline(time_s, color=style.TRUTH, linewidth=1.1, linestyle=dash)


def _legend(figure: Figure | SubFigure, case: Case, place: Place = "outside upper center") -> None:
    entries = [
        (_sample(style.colour(t.signal)), signal_spec(t.signal).composite) for t in case.tracks
    ]
    if case.satellite.alarms:
        entries += [
            (_sample(case.colour), f"found: onset {case.onset_s:.2f} s"),
            (_sample(case.colour, DOTTED), f"found: alarm {case.alarm_s:.2f} s"),
        ]
    if case.suspicion_s is not None:
        entries.append((_sample(SUSPICION, DOTTED), f"first suspicion {case.suspicion_s:.2f} s"))
    for _, text, dash in case.truth.lines() if case.truth is not None else ():
        entries.append((_sample(style.TRUTH, dash), text))
    handles, names = zip(*entries, strict=True)
    figure.legend(
        handles,
        names,
        loc=place,
        ncols=5 if len(entries) <= 5 else 4,
        handlelength=2.4,
    )


def _sample(colour: str, dash: Dash = SOLID) -> Line2D:
    return Line2D([], [], color=colour, linewidth=1.8, linestyle=dash)


def _peaks(figure: SubFigure, case: Case, bands: int) -> None:
    last_s = max(a.alarm_s for a in case.satellite.alarms)
    parts = stretches(case.onset_s, last_s, case.log.duration_s)
    axes = figure.subplots(1, len(parts) * bands, sharex=True, sharey=True, squeeze=False)[0]
    for number, track in enumerate(case.whole):
        mine = axes[number * len(parts) : (number + 1) * len(parts)]
        draw_peaks(mine, track, parts, captured=track.signal == case.satellite.band)
    reach = max(float(np.abs(axis.get_xlim()).max()) for axis in axes)
    axes[0].set_xlim(-max(1.05 * reach, 0.55), max(1.05 * reach, 0.55))
    axes[0].set_ylabel("Correlation peak\n(before = 1)")
    figure.supxlabel("Tap delay (chips, positive = late); grey: before", fontsize=9)
