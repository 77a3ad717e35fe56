"""Pictures of the study: statistics, curves, bearings and maps; PNG."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtri

from sdr_spoof.aiding.array import motion
from sdr_spoof.report.figures import style

from . import published

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from sdr_spoof.aiding.array.config import Form

    Floats = NDArray[np.float64]

COLOURS = ("#0072b2", "#e08214", "#009e73", "#cc79a7", "#56b4e9", "#d55e00")
PFAS = np.logspace(-4, 0, 200)


def draw_statistic(moved_m: Floats, draws: Mapping[str, Mapping[Form, list[Floats]]]) -> bytes:
    """Figure 6: the published statistic and the matched one by the way gone."""

    def draw(figure: Figure) -> None:
        panels = (("pair", "a) published statistic nu"), ("matched", "b) matched statistic"))
        for axes, (form, title) in zip(figure.subplots(1, 2), panels, strict=True):
            for (name, values), colour in zip(draws.items(), COLOURS, strict=False):
                stacked = np.array(values[form])  # type: ignore[index]
                low, high = np.quantile(stacked, [0.01, 0.99], axis=1)
                axes.plot(moved_m, stacked.mean(axis=1), "o-", color=colour, label=name)
                axes.fill_between(moved_m, low, high, color=colour, alpha=0.15, lw=0)
            limit = motion.threshold(form, 2, published.PFA)  # type: ignore[arg-type]
            axes.axhline(limit, color=style.ALARM, ls="--", label="threshold, Pfa 1 %")
            axes.set(xlabel="way gone (m)", ylabel="statistic")
            axes.set_title(title)
        figure.axes[0].legend(loc="upper left")

    return style.png(draw, 9.6, 3.8)


def draw_roc(lines: Sequence[tuple[str, float]], dots: Mapping[str, Floats]) -> bytes:
    """Detection probability by false-alarm probability: laws as lines, draws as dots."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for (label, noncentral), colour in zip(lines, COLOURS, strict=False):
            pd = [float(published.detected(noncentral, pfa)) for pfa in PFAS]
            axes.plot(PFAS, pd, color=colour, label=label)
        for (_, values), colour in zip(dots.items(), COLOURS, strict=False):
            pd = [float(np.mean(values > motion.threshold("matched", 2, p))) for p in PFAS[::12]]
            axes.plot(PFAS[::12], pd, "o", ms=3.5, color=colour)
        axes.set(xscale="log", xlabel="false-alarm probability", ylabel="detection probability")
        axes.set(xlim=(PFAS[0], 1.0), ylim=(0.0, 1.02))
        axes.legend(loc="lower right")

    return style.png(draw, 6.4, 4.2)


def draw_bearings(bearing_deg: Floats, curves: Mapping[str, Floats], label: str) -> bytes:
    """Detection probability around the horizon."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for (name, pd), colour in zip(curves.items(), COLOURS, strict=False):
            axes.plot(bearing_deg, pd, color=colour, label=name)
        axes.set(xlabel=label, ylabel="detection probability", xlim=(0, 360), ylim=(0, 1.03))
        axes.set_xticks(np.arange(0, 361, 45))
        axes.legend(loc="lower right")

    return style.png(draw, 6.4, 3.8)


def draw_maps(maps: Mapping[str, Floats], reach_m: float) -> bytes:
    """Detection probability of spoofers on the ground around the vehicle, a panel each."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, len(maps), sharey=True)
        extent = (-reach_m / 1e3, reach_m / 1e3, -reach_m / 1e3, reach_m / 1e3)
        for axes, (title, pd) in zip(panels, maps.items(), strict=True):
            image = axes.imshow(
                pd, origin="lower", extent=extent, vmin=0, vmax=1, cmap="viridis", rasterized=True
            )
            axes.contour(pd, levels=[0.95], colors="white", linewidths=1.0, extent=extent)
            axes.annotate("", (0, 0.3), (0, 0), arrowprops={"arrowstyle": "->", "color": "white"})
            axes.set_title(title)
            axes.set_xlabel("east (km)")
            axes.grid(False)
        panels[0].set_ylabel("north (km)")
        figure.colorbar(image, ax=panels, label="detection probability", shrink=0.85)

    return style.png(draw, 9.6, 3.9)


def draw_law(samples: Mapping[str, Floats], form: Form, epochs: int) -> bytes:
    """Histogram of a statistic under H0 over its law, on the scale of tail probabilities."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for (name, values), colour in zip(samples.items(), COLOURS, strict=False):
            ordered = np.sort(values[np.isfinite(values)])
            tail = 1.0 - (np.arange(ordered.size) + 0.5) / ordered.size
            axes.plot(ordered, tail, color=colour, label=name)
        top = float(chdtri(2, 1e-4)) if form != "matched" else 3.8
        grid = np.linspace(0, top, 200)
        law = motion.p_value(grid, form, epochs)
        axes.plot(grid, law, color=style.INK, ls="--", label="law under H0")
        axes.set(yscale="log", ylim=(3e-4, 1.2), xlim=(0, 1.1 * top))
        axes.set(xlabel="statistic", ylabel="share above")
        axes.legend(loc="upper right")

    return style.png(draw, 6.4, 4.0)
