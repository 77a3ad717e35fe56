"""Picture of what the receiver detects against the drag, and how soon."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.campaign.analysis import wilson
from sdr_spoof.detectors import combo_model as model
from sdr_spoof.report.figures import style

from . import published
from .receiver import methods

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .sweep import Result

COLOURS = ("#0072b2", "#009e73", "#cc79a7", "#56b4e9")


def draw_detection(results: Sequence[Result]) -> bytes:
    """Pd and median latency of each method against the drag, and losses of lock; PNG.

    Slow drags on the left, those of the publication on the right.
    """
    first = published.DRAGS_HZ[0]
    groups = [
        group
        for group in (
            [r for r in results if r.point.drag_hz < first],
            [r for r in results if r.point.drag_hz >= first],
        )
        if group
    ]

    def draw(figure: Figure) -> None:
        panels = figure.subplots(2, len(groups), sharey="row", sharex="col", squeeze=False)
        for column, group in enumerate(groups):
            share, when = panels[:, column]
            slow = group[0].point.drag_hz < first
            _draw_group(share, when, group, slow=slow)
            share.set_title("slow drags" if slow else "drags of the publication")
        panels[0, 0].set_ylabel("share of runs")
        panels[1, 0].set_ylabel("median time after\nthe drag's start (s)")
        handles, labels = panels[0, -1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)

    return style.png(draw, 9.6, 5.4)


def _draw_group(share: Axes, when: Axes, results: Sequence[Result], *, slow: bool) -> None:
    drags = [r.point.drag_hz for r in results]
    for number, (method, colour) in enumerate(zip(methods(), COLOURS, strict=False)):
        _draw_share(share, results, number, colour, method.title)
        medians = [_median(r.detected(number)) for r in results]
        when.plot(drags, medians, "o-", ms=4, color=colour)
    broke = [r.lost / len(r.held) if r.held else np.nan for r in results]
    share.plot(drags, broke, "x--", color=style.ALARM, label="joint tracking broke")
    when.plot(drags, [_lost(r) for r in results], "x--", color=style.ALARM)
    _draw_model(share, drags)
    share.set_ylim(-0.03, 1.03)
    when.set_xlabel("drag f_e (Hz)")
    if slow:
        when.set_xscale("log")
        when.set_xticks(drags, [f"{f:g}" for f in drags])
        when.minorticks_off()


def _draw_share(
    axes: Axes, results: Sequence[Result], number: int, colour: str, label: str
) -> None:
    """Pd of one method with its Wilson intervals; points that nothing was tested at left out."""
    tested = [r for r in results if r.tested(number)]
    hits = np.array([len(r.detected(number)) for r in tested])
    trials = np.array([r.tested(number) for r in tested])
    low, high = wilson(hits, trials)
    share = hits / trials
    bars = np.maximum([share - low, high - share], 0.0)
    drags = [r.point.drag_hz for r in tested]
    axes.errorbar(drags, share, yerr=bars, fmt="o-", ms=4, color=colour, label=label)


def _draw_model(axes: Axes, drags: Sequence[float]) -> None:
    """Equation 26 with C/N0 = 30 as a ratio, the printed curve."""
    cn0 = model.PUBLISHED_CN0_HZ["as_ratio"]
    fll = model.fll_sigma_hz(cn0, published.INTEGRATION_S, published.LOOP_BANDWIDTH_HZ)
    sigma = model.difference_sigma_hz(fll, fll)
    fine = np.geomspace(min(drags), max(drags), 200)
    pd = model.detection_probability(
        model.capture_rate_small_angle_hz(fine, published.ETA),
        sigma,
        model.threshold_for_pfa_hz(sigma, published.PFA),
    )
    axes.plot(fine, pd, ":", color=style.INK, label="published curve")


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float("nan")


def _lost(result: Result) -> float:
    return _median([r.lost_s for r in result.held if np.isfinite(r.lost_s)])
