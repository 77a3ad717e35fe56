"""Figures of a campaign, from the tables of :mod:`sdr_spoof.campaign.analysis`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from sdr_spoof.report.figures.style import INK, MUTED, RC

from .analysis import wilson

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from .analysis import Rows

COLOURS = (
    *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d31"),
)
"""Okabe-Ito hues."""
MARKERS = "osD^vP*X"
MOST_LINES = len(COLOURS)
"""Lines of one panel; further ones are left out, and the title says so."""
MOST_CURVES = 4
"""ROC curves of one panel: more hide each other."""
MOST_PANELS = 9
_PANEL_IN = (4.6, 3.3)
_BESIDE_IN = 0.05
"""Points of neighbouring lines stand beside each other."""
_BAND = 0.13
"""Opacity of an interval."""


def detection_figure(path: Path, rows: Rows, axes_names: Sequence[str], title: str) -> bool:
    """Draw Pd against the longest numeric axis, a panel per detector; False if there is none.

    Without any attack it is the share of false alarms.
    """
    along = longest_axis(rows, axes_names)
    if along is None:
        return False
    others = [name for name in axes_names if name != along]
    if len({row["attack"] for row in rows if row["hostile"]}) > 1:
        others.append("attack")
    hostile = [row for row in rows if row["hostile"]]
    what = "probability of detection" if hostile else "share of alarms"
    rows = hostile or rows
    panels = _grouped(rows, lambda row: str(row["detector"]))

    def draw(axes: Axes, name: str) -> None:
        lines = _grouped(panels[name], lambda row: _named(row, others))
        _scale(axes, [row[along] for row in rows])
        shown = list(lines.items())[:MOST_LINES]
        for number, (label, line) in enumerate(shown):
            beside = (number - (len(shown) - 1) / 2) * _BESIDE_IN
            _line(axes, sorted(line, key=lambda row: row[along]), along, label, number, beside)
        more = len(lines) - MOST_LINES
        axes.set_title(_words(name) + (f" ({more} lines more in the table)" if more > 0 else ""))
        axes.set(xlabel=with_unit(along), ylabel=what, ylim=(-0.03, 1.05))

    _panels(path, list(panels), draw, title, legend=bool(others))
    return True


def coverage_figure(path: Path, rows: Rows, title: str) -> bool:
    """Draw the table attack x detector, with share of alarms and median latency in each cell.

    What is no attack is named in brackets: there an alarm is a false one.
    """
    rows = [row if row["hostile"] else {**row, "attack": f"({row['attack']})"} for row in rows]
    attacks = list(dict.fromkeys(row["attack"] for row in rows))
    detectors = list(dict.fromkeys(row["detector"] for row in rows))
    if not attacks:
        return False
    cells = {(row["attack"], row["detector"]): row for row in rows}
    shares = np.full((len(attacks), len(detectors)), np.nan)
    for (attack, detector), row in cells.items():
        shares[attacks.index(attack), detectors.index(detector)] = row["alarm"]
    with rc_context(RC):  # type: ignore[arg-type]
        size = (2.6 + 1.35 * len(detectors), 1.7 + 0.62 * len(attacks))
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots()
        image = axes.imshow(shares, vmin=0, vmax=1, cmap="Blues", aspect="auto")
        axes.set_xticks(np.arange(len(detectors) - 1) + 0.5, minor=True)
        axes.set_yticks(np.arange(len(attacks) - 1) + 0.5, minor=True)
        axes.grid(which="minor", color="white", linewidth=2)
        for (attack, detector), row in cells.items():
            place = (detectors.index(detector), attacks.index(attack))
            axes.annotate(
                _cell(row), place, ha="center", va="center", fontsize=8.5, color=_ink(row["alarm"])
            )
        axes.set_xticks(range(len(detectors)), [_words(d, "\n") for d in detectors])
        axes.set_yticks(range(len(attacks)), attacks)
        axes.tick_params(which="both", length=0, labelcolor=INK)
        axes.grid(visible=False, which="major")
        axes.spines[:].set_visible(False)
        figure.suptitle(title, fontsize=11, fontweight="bold")
        bar = figure.colorbar(image, label="share of alarms", pad=0.02)
        bar.outline.set_visible(False)
        _save(figure, path)
    return True


def latency_figure(
    path: Path, groups: dict[str, dict[str, NDArray[np.float64]]], title: str, since: str
) -> bool:
    """Draw the share of attacks found within a time; a panel per attack, a line per detector.

    Args:
        path: PNG file to write.
        groups: latencies in s of all trials of each attack and detector, NaN for not found.
        title: of the figure.
        since: what the time is counted from the start of.
    """
    drawn = {
        attack: {name: times for name, times in lines.items() if (~np.isnan(times)).any()}
        for attack, lines in groups.items()
    }
    drawn = {attack: lines for attack, lines in drawn.items() if lines}
    if not drawn:
        return False
    detectors = list(dict.fromkeys(name for lines in drawn.values() for name in lines))

    def draw(axes: Axes, attack: str) -> None:
        ends = [np.nanmax(times) for times in drawn[attack].values()]
        starts = [min(0.0, np.nanmin(times)) for times in drawn[attack].values()]
        span = (min(starts), max(*ends, min(starts) + 0.1) * 1.05)
        for name, times in drawn[attack].items():
            _distribution(axes, times, span, _words(name), detectors.index(name))
        axes.set_title(attack)
        axes.set(
            xlabel=f"time since the {since}'s start (s)", ylabel="found by then", ylim=(-0.03, 1.05)
        )

    _panels(path, list(drawn), draw, title, legend=True)
    return True


def roc_figure(path: Path, rows: Rows, axes_names: Sequence[str], title: str) -> bool:
    """Draw detections against false alarms, a panel per detector, a line per point."""
    panels = _grouped(rows, lambda row: str(row["detector"]))
    if not panels:
        return False

    def draw(axes: Axes, name: str) -> None:
        lines = _grouped(panels[name], lambda row: _named(row, axes_names))
        chosen = _spread(list(lines.items()), MOST_CURVES)
        for number, (label, line) in enumerate(chosen):
            pfa = [0.0, *(row["pfa"] for row in line)]
            pd = [0.0, *(row["pd"] for row in line)]
            axes.plot(pfa, pd, color=COLOURS[number], label=label, drawstyle="steps-post")
            low = [0.0, *(row["pd_low"] for row in line)]
            high = [line[0]["pd_high"], *(row["pd_high"] for row in line)]
            axes.fill_between(pfa, low, high, color=COLOURS[number], alpha=_BAND, lw=0, step="post")
        axes.plot([0, 1], [0, 1], color=MUTED, lw=0.8, ls=":")
        more = len(lines) - len(chosen)
        axes.set_title(_words(name) + (f" ({more} points more in the table)" if more else ""))
        axes.set(xlabel="clean satellites beyond the threshold", ylabel="attacked ones beyond it")
        axes.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.04))

    _panels(path, list(panels), draw, title, legend=bool(axes_names))
    return True


def longest_axis(rows: Rows, names: Sequence[str]) -> str | None:
    """The numeric axis with the most values, two or more."""
    counts = {
        name: len({row[name] for row in rows})
        for name in names
        if rows and all(isinstance(row[name], float) for row in rows)
    }
    best = max(counts, key=lambda name: counts[name], default=None)
    return best if best is not None and counts[best] > 1 else None


def with_unit(name: str) -> str:
    """``drag_rate_m_s`` -> ``drag rate (m/s)``."""
    units = {
        "_m_s": "m/s",
        "_m_s2": "m/s²",
        "_dbhz": "dB-Hz",
        "_db": "dB",
        "_hz": "Hz",
        "_hz_s": "Hz/s",
        "_cycles": "cycles",
        "_ms": "ms",
        "_s": "s",
        "_m": "m",
    }
    endings = [ending for ending in units if name.endswith(ending)]
    ending = max(endings, key=len, default="")
    plain = name.removesuffix(ending).replace("_", " ").replace("cn0", "C/N0")
    return f"{plain} ({units[ending]})" if ending else plain


def _panels(
    path: Path, names: Sequence[str], draw: Callable[[Axes, str], None], title: str, *, legend: bool
) -> None:
    """Equal panels, one per name, with one legend for all."""
    shown = names[:MOST_PANELS]
    across = min(3, len(shown)) if len(shown) != 4 else 2
    down = math.ceil(len(shown) / across)
    with rc_context(RC):  # type: ignore[arg-type]
        width = max(across * _PANEL_IN[0], 6.4)
        figure = Figure(figsize=(width, down * _PANEL_IN[1] + 0.5), layout="constrained")
        grid = figure.subplots(down, across, squeeze=False).ravel()
        for axes, name in zip(grid, shown, strict=False):
            draw(axes, name)
        for axes in grid[len(shown) :]:
            axes.set_visible(False)
        handles = {
            label: handle
            for axes in grid[: len(shown)]
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        if legend and handles:
            figure.legend(
                list(handles.values()),
                list(handles),
                loc="outside lower center",
                ncols=max(1, min(len(handles), int(10 * width / (max(map(len, handles)) + 6)))),
            )
        figure.suptitle(title, fontsize=11, fontweight="bold")
        _save(figure, path)


def _line(axes: Axes, rows: Rows, along: str, label: str, number: int, beside_in: float) -> None:
    """Pd along an axis with its intervals."""
    x = [row[along] for row in rows]
    y = np.array([row["alarm"] for row in rows])
    low, high = (np.array([row[end] for row in rows]) for end in ("alarm_low", "alarm_high"))
    axes.errorbar(
        x,
        y,
        np.clip([y - low, high - y], 0, None),
        color=COLOURS[number],
        marker=MARKERS[number],
        markersize=4.5,
        capsize=2,
        elinewidth=0.9,
        label=label,
        transform=axes.transData + ScaledTranslation(beside_in, 0, axes.figure.dpi_scale_trans),
    )


def _distribution(
    axes: Axes,
    times: NDArray[np.float64],
    span: tuple[float, float],
    label: str,
    number: int,
) -> None:
    """Share of the trials found by a time, with its interval at each time."""
    grid = np.linspace(*span, 400)
    found = np.searchsorted(np.sort(times[~np.isnan(times)]), grid, side="right")
    low, high = wilson(found, times.size)
    colour = COLOURS[number % MOST_LINES]
    axes.plot(grid, found / times.size, color=colour, label=label)
    axes.fill_between(grid, low, high, color=colour, alpha=_BAND, lw=0)


def _scale(axes: Axes, values: Sequence[float]) -> None:
    """Logarithmic where the values span more than a factor of 30."""
    if min(values) > 0 and max(values) > 30 * min(values):
        axes.set_xscale("log")


def _grouped(rows: Rows, key: Callable[[dict[str, Any]], str]) -> dict[str, Rows]:
    groups: dict[str, Rows] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def _spread(items: list[Any], most: int) -> list[Any]:
    """No more than so many of the items, evenly from first to last."""
    if len(items) <= most:
        return items
    return [items[round(k)] for k in np.linspace(0, len(items) - 1, most)]


def _named(row: dict[str, Any], names: Sequence[str]) -> str:
    """``drag rate 0.5 m/s, C/N0 45 dB-Hz``."""
    parts = []
    for name in names:
        plain, _, unit = with_unit(name).rstrip(")").partition(" (")
        value = row[name]
        shown = f"{value:.4g}" if isinstance(value, float) else value
        parts.append(" ".join(filter(None, (plain, shown, unit))))
    return ", ".join(parts)


def _cell(row: dict[str, Any]) -> str:
    latency = row["median_on_air_s"]
    share = f"{row['alarm']:.3f}".rstrip("0").rstrip(".")
    return share if math.isnan(latency) else f"{share}\n{latency:.2g} s"


def _ink(share: float) -> str:
    return "white" if share > 0.6 else INK


def _words(name: str, space: str = " ") -> str:
    words = ["GLR" if word == "glr" else word for word in name.split("_")]
    return space.join(words)


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=140, metadata={"Software": None})
