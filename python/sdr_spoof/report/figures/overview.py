"""One look at an attack: every kind of evidence of one satellite on one time axis."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.figures import style, tracking_bar
from sdr_spoof.report.figures.case import Case
from sdr_spoof.report.figures.evidence_panels import evidence_panels
from sdr_spoof.report.figures.panels import Panel
from sdr_spoof.report.figures.peaks import draw_peaks, stretches
from sdr_spoof.report.figures.style import SOLID, Dash
from sdr_spoof.signals import signal_spec

SUSPICION = style.VERDICTS["suspect"]
DOTTED: Dash = (0, (2, 2))
Part = tuple[float, Callable[[Axes, Case], None]]
"""Height of a panel in inches, and what draws it."""


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


def _panels(case: Case) -> list[Part]:
    found: list[Part] = [(0.35 + 0.2 * len(case.tracks), tracking_bar.draw)]
    for panel in evidence_panels(case.evidence, case.onset_s):
        found.append((panel.look.height_in, _whole(panel)))
    return [*found, (1.1, _cn0), (0.75, _noise)]


def _whole(panel: Panel) -> Callable[[Axes, Case], None]:
    def draw(axes: Axes, _: Case) -> None:
        panel.look.dress(axes)
        panel.fill(axes)

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


def _legend(figure: SubFigure, case: Case) -> None:
    entries = [
        (style.sample(style.colour(t.signal), SOLID, 1.8), signal_spec(t.signal).composite)
        for t in case.tracks
    ]
    entries += [
        (style.sample(case.colour, SOLID, 1.8), f"found: onset {case.onset_s:.2f} s"),
        (style.sample(case.colour, DOTTED, 1.8), f"found: alarm {case.alarm_s:.2f} s"),
    ]
    if case.suspicion_s is not None:
        text = f"first suspicion {case.suspicion_s:.2f} s"
        entries.append((style.sample(SUSPICION, DOTTED, 1.8), text))
    for _, text, dash in case.truth.lines() if case.truth is not None else ():
        entries.append((style.sample(style.TRUTH, dash, 1.8), text))
    figure.legend(
        *zip(*entries, strict=True),
        loc="outside upper center",
        ncols=5 if len(entries) <= 5 else 4,
        handlelength=2.4,
    )


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
