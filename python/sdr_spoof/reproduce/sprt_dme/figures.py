"""Pictures of the study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2, norm

from sdr_spoof.report.figures import style

from . import published

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from .trials import Delays

COLOURS = {
    "sprt-classic": "#009e73",
    "improved-sprt": "#e08214",
    "cusum": "#cc79a7",
    "glr-windows": "#0072b2",
    "improved-sprt-as-printed": "#66727f",
}
BY_COUNT = ("#0072b2", "#56b4e9", "#009e73", "#e08214", "#c0392b")


def figure5(paths: Mapping[str, np.ndarray], delays: Mapping[str, Delays]) -> bytes:
    """Paths of one run, and the distribution of the delays of all."""

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
        for name, path in paths.items():
            dashed = ":" if name.endswith("as-printed") else "-"
            left.plot(path, dashed, color=COLOURS[name], label=name, lw=1.4)
        left.axhline(published.THRESHOLD, color=style.ALARM, ls="--", lw=1.0)
        left.text(2, published.THRESHOLD + 0.5, "threshold 11.51", color=style.ALARM, fontsize=8)
        left.axvline(published.ONSET_S, color=style.TRUTH, lw=1.0)
        left.text(published.ONSET_S - 3, 37, "attack", fontsize=8, ha="right")
        left.set(xlabel="time (s)", ylabel="statistic", ylim=(-8, 40), xlim=(0, 300))
        left.set_title("a) one run, shift 1.48 standard deviations")
        left.legend(loc="upper left", fontsize=8)
        for name, d in delays.items():
            values = np.sort(np.minimum(d.values_s, 1e4))
            share = np.arange(1, values.size + 1) / values.size
            right.step(values, share, where="post", color=COLOURS[name], label=name)
        for name, printed in published.FIGURE5_S.items():
            right.plot([printed], [0.5], "o", color=COLOURS[name], ms=6)
        right.axvline(published.WITHIN_S, color=style.MUTED, ls="--", lw=0.8)
        right.set(xlabel="delay (s)", ylabel="share of runs alarmed", xlim=(0, 90), ylim=(0, 1.02))
        right.set_title("b) delays; dots: as printed")
        right.legend(loc="lower right", fontsize=8)

    return style.png(draw, 9.6, 3.8)


def equal_delays(delays: Mapping[str, Mapping[float, Delays]]) -> bytes:
    """Mean delay over shift; dots are the reference."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for name, of in delays.items():
            axes.loglog(list(of), [d.mean_s for d in of.values()], color=COLOURS[name], label=name)
            axes.plot(
                published.SHIFTS, published.REFERENCE_DELAYS[name], "o", color=COLOURS[name], ms=5
            )
        axes.set(xlabel="shift (standard deviations)", ylabel="mean delay (s)")
        axes.set_xticks(published.SHIFTS, [f"{s:g}" for s in published.SHIFTS])
        axes.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
        axes.minorticks_off()
        axes.set_title("1 % false alarms an hour; dots: independent study")
        axes.legend()

    return style.png(draw, 6.4, 4.0)


def figure4(
    shares: Mapping[tuple[str, int], Mapping[str, np.ndarray]], feedbacks: Sequence[str]
) -> bytes:
    """A column a feedback, a row a test, a line a number of spoofed satellites."""

    def draw(figure: Figure) -> None:
        grid = figure.subplots(2, len(feedbacks), sharex=True, sharey=True)
        for row, test in zip(grid, ("improved", "default"), strict=True):
            for axes, feedback in zip(row, feedbacks, strict=True):
                for count, colour in enumerate(BY_COUNT, start=1):
                    values = shares[feedback, count][test]
                    axes.plot(published.SIZES_M, values, "o-", ms=3, color=colour, label=str(count))
                title = {"improved": "improved", "default": "default rule"}[test]
                axes.set_title(
                    f"{title}, {feedback}" if feedback != "none" else f"{title}, no feedback"
                )
        for axes in grid[-1]:
            axes.set(xlabel="spoofing (m)", ylim=(-0.03, 1.05))
        for axes in grid[:, 0]:
            axes.set(ylabel="found within 30 s")
        grid[0, 0].legend(title="spoofed", loc="lower right", fontsize=8)

    return style.png(draw, 11.5, 5.6)


def figure6(curves: Mapping[float, Mapping[str, float]]) -> bytes:
    """Shares over the size of the spoofing."""
    colours = {
        "improved on Delta": "#e08214",
        "likelihood ratio on Delta": "#0072b2",
        "likelihood ratio on parity": "#009e73",
        "RAIM": "#c0392b",
        "AAIM": "#cc79a7",
    }

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for name in next(iter(curves.values())):
            base, published_too = name.removesuffix(", as published"), name.endswith("as published")
            values = [curves[s][name] for s in published.SIZES_M]
            line = "-" if published_too else "--"
            axes.plot(published.SIZES_M, values, line, color=colours[base], label=name, lw=1.6)
        axes.set(
            xlabel="spoofing of one satellite (m)", ylabel="found within 30 s", ylim=(-0.03, 1.05)
        )
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8)

    return style.png(draw, 9.2, 4.4)


def dme(
    drags: Mapping[float, Delays],
    turned: Mapping[float, Mapping[str, Delays]],
    run: tuple[np.ndarray, np.ndarray, float],
) -> bytes:
    """One run; shares over time by drag; shares by bearing."""

    def draw(figure: Figure) -> None:
        first, middle, last = figure.subplots(1, 3)
        time_s, path, threshold = run
        first.plot(time_s, path, color="#0072b2", lw=1.3)
        first.axhline(threshold, color=style.ALARM, ls="--", lw=1.0)
        alarm = int(np.argmax(path > threshold))
        if path[alarm] > threshold:
            first.axvline(time_s[alarm], color=style.ALARM, lw=1.0)
        first.axvline(published.ONSET_S, color=style.TRUTH, lw=1.0)
        first.set(xlabel="time (s)", ylabel="log-likelihood ratio of the DME difference")
        first.set_title("a) 2 m/s, one run")
        for (rate, d), shade in zip(drags.items(), np.linspace(0.25, 1.0, len(drags)), strict=True):
            values = np.sort(np.minimum(d.values_s, 1e4))
            share = np.arange(1, values.size + 1) / values.size
            middle.step(
                values, share, where="post", color="#0072b2", alpha=shade, label=f"{rate:g} m/s"
            )
        middle.set(
            xlabel="time since the onset (s)", ylabel="share found", xlim=(0, 120), ylim=(0, 1.02)
        )
        middle.set_title("b) by speed of the drag")
        middle.legend(fontsize=8)
        shares = [d["dme-difference"].within(120) for d in turned.values()]
        last.plot(list(turned), shares, "o-", color="#0072b2", ms=3, label="DME difference")
        shares = [d["fitted"].within(120) for d in turned.values()]
        last.plot(list(turned), shares, "o-", color="#e08214", ms=3, label="Delta, any satellite")
        last.set(
            xlabel="bearing of the drag (deg)", ylabel="found within 120 s", ylim=(-0.03, 1.05)
        )
        last.set_title("c) 2 m/s by bearing")
        last.legend(fontsize=8)

    return style.png(draw, 11.5, 3.7)


def laws(histograms: Mapping[str, tuple[np.ndarray, str]]) -> bytes:
    """A panel a statistic: measured density and law."""

    def draw(figure: Figure) -> None:
        grid = figure.subplots(2, -(-len(histograms) // 2)).ravel()
        for axes, (name, (values, law)) in zip(grid, histograms.items(), strict=False):
            if law == "normal":
                x = np.linspace(-4.5, 4.5, 91)
                density = norm.pdf(x)
            else:
                x = np.linspace(0.0, 20.0, 81)
                # The density of one degree of freedom is infinite at zero: by bins.
                density = np.gradient(chi2.cdf(x, int(law[-1])), x)
            axes.hist(values, bins=x, density=True, color="#9ecae1")
            axes.plot(x, density, color=style.INK, lw=1.2)
            axes.set_yscale("log")
            axes.set_ylim(1e-5, 2.0)
            axes.set_title(name, fontsize=8)
            axes.set_xlabel(
                "standard deviations" if law == "normal" else "sum of squares", fontsize=8
            )
        for axes in grid[len(histograms) :]:
            axes.set_visible(False)
        grid[0].set_ylabel("density")

    return style.png(draw, 11.5, 5.2)


def roc(points: Mapping[str, Sequence[tuple[float, float, float]]], shift: float) -> bytes:
    """Shares found over false alarms."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for name, of in points.items():
            _, false, found = np.array(of).T
            kept = false > 1e-8
            axes.semilogx(false[kept], found[kept], color=COLOURS[name], label=name)
        axes.axvline(published.PER_HOUR, color=style.MUTED, ls="--", lw=0.8)
        axes.set(
            xlabel="false-alarm probability in 1 h",
            ylabel=f"found within 30 s, r = {shift:g}",
            xlim=(1e-7, 1.0),
            ylim=(-0.03, 1.05),
        )
        axes.legend(loc="upper left", fontsize=8)

    return style.png(draw, 6.4, 4.0)
