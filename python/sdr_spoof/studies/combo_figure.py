"""Figure of the study of the combo."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from typing import Any

    from .combo import Hold, Value

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#882255")


def draw(path: Path, noise: Sequence[Value], hold: Sequence[Hold]) -> None:
    """Noise of each range against C/N0, and the share of runs that hold; dashed: single."""
    with mpl.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        figure = Figure(figsize=(10, 4.5), layout="constrained")
        left, right = figure.subplots(1, 2)
        _noise(left, noise)
        _hold(right, hold)
        figure.suptitle("Two bands as one signal (solid) and each on its own (dashed)")
        figure.savefig(path, dpi=120, metadata={"Software": None})


def _noise(axes: Any, noise: Sequence[Value]) -> None:
    names = dict.fromkeys(v.quantity for v in noise)
    for name, colour in zip(names, COLOURS, strict=False):
        points = [v for v in noise if v.quantity == name]
        cn0 = [v.cn0_dbhz for v in points]
        axes.semilogy(cn0, [v.combo_mm for v in points], color=colour, label=name)
        axes.semilogy(cn0, [v.single_mm for v in points], "--", color=colour)
    axes.set(title="Noise", xlabel="C/N0, dB-Hz", ylabel="1 sigma, mm")
    axes.legend(frameon=False, fontsize=8)


def _hold(axes: Any, hold: Sequence[Hold]) -> None:
    names = dict.fromkeys(h.bands for h in hold)
    for name, colour in zip(names, COLOURS, strict=False):
        for combo, line in ((True, "-"), (False, "--")):
            points = [h for h in hold if (h.bands, h.combo) == (name, combo)]
            share = [h.held / h.runs for h in points]
            cn0 = [h.cn0_dbhz for h in points]
            axes.plot(cn0, share, line, color=colour, label=name if combo else None)
    axes.axhline(0.95, color="0.5", linewidth=0.8)
    axes.set(title="Lock held for 20 s", xlabel="C/N0, dB-Hz", ylabel="share of runs")
    axes.legend(frameon=False)
