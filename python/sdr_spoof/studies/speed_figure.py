"""Figure of the speed study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .speed import CLOSE

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

    from .speed import Cost

COLOURS = {
    "front end of a band": "#666666",
    "B1I": "#0072B2",
    "B1C, BOC(1,1)": "#D55E00",
    "B1C, QMBOC and data": "#009E73",
    "8 samples apart": "#0072B2",
    "next to each other": "#CC79A7",
    "W1": "#0072B2",
    "W2": "#009E73",
}

_ROOM = 1.25
"""Of an axis, so that the legend lies above the lines."""


def draw(path: Path, costs: Sequence[Cost], *, cores: int) -> None:
    """Cost against sample rate, channels, taps and threads, one panel each."""
    with mpl.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        figure = Figure(figsize=(10, 7.5), layout="constrained")
        (by_rate, by_channels), (by_taps, by_threads) = figure.subplots(2, 2)
        for axes, against in (
            (by_rate, "msps"),
            (by_channels, "channels"),
            (by_taps, "taps"),
            (by_threads, "threads"),
        ):
            _lines(axes, [c for c in costs if c.against == against])
        by_rate.set(
            title="Front end, and one channel more (5 taps)",
            xlabel="sample rate, Msps (taps: solid 8 samples, dashed 67 ns apart)",
        )
        _log(by_rate, [c for c in costs if c.against == "msps"])
        by_channels.set(title="One band, real int8 at 120 Msps, 5 taps", xlabel="channels")
        by_taps.set(title="One B1I channel more, 120 Msps", xlabel="taps")
        by_threads.set(title=f"24 channels, 120 Msps, {cores} cores", xlabel="threads")
        for axes in (by_rate, by_channels, by_taps):
            axes.set_ylabel("core time, µs per ms of signal")
        by_threads.set_ylabel("time, µs per ms of signal")
        for axes in (by_channels, by_taps, by_threads):
            axes.set_ylim(0, _ROOM * axes.get_ylim()[1])
        by_threads.xaxis.set_major_locator(
            FixedLocator(sorted({c.value for c in costs if c.against == "threads"}))
        )
        by_threads.axvline(cores, color="0.5", linewidth=1, linestyle=":", zorder=0)
        figure.savefig(path, dpi=120, metadata={"Software": None})


def _lines(axes: Axes, costs: Sequence[Cost]) -> None:
    for what in dict.fromkeys(c.what for c in costs):
        points = [(c.value, c.us_per_ms) for c in costs if c.what == what]
        kind = what.removesuffix(CLOSE)
        close = kind != what
        axes.plot(
            *zip(*points, strict=True),
            linestyle="--" if close else "-",
            marker="o",
            markersize=4,
            color=COLOURS[kind],
            label=None if close else what,
        )
    axes.legend(frameon=False, loc="upper left", ncols=2)


def _log(axes: Axes, costs: Sequence[Cost]) -> None:
    """Logarithmic axes with plain numbers."""
    axes.set(xscale="log", yscale="log")
    axes.set_ylim(top=3 * axes.get_ylim()[1])  # room for the legend
    axes.xaxis.set_major_locator(FixedLocator(sorted({c.value for c in costs})))
    axes.xaxis.set_minor_locator(NullLocator())
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_major_formatter(plain)
    axes.yaxis.set_major_formatter(plain)
