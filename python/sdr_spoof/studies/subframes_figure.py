"""Figure of the subframe errors of D1 and LNAV."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure

from .subframes import CODES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .subframes import Point

COLOURS = ("#0072B2", "#D55E00")
LOWEST = 2e-5


def draw(path: Path, points: Sequence[Point]) -> None:
    """Subframes lost by most likely words (marks) and by decisions by sign (dashes)."""
    with mpl.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        figure = Figure(figsize=(7.5, 4.5), layout="constrained")
        axes = figure.subplots()
        for code, colour in zip(CODES, COLOURS, strict=True):
            own = [p for p in points if p.code == code]
            for field, style, what in (
                ("lost_rate", "o-", "lost"),
                ("wrong_rate", "x:", "with a wrong word"),
                ("hard_rate", "--", "lost by decisions by sign alone"),
            ):
                seen = [(p.cn0_dbhz, getattr(p, field)) for p in own if getattr(p, field)]
                if seen:
                    axes.semilogy(*zip(*seen, strict=True), style, color=colour, markersize=4,
                                  label=f"{code} {what}")  # fmt: skip
        axes.set(xlabel="C/N0, dB-Hz (D2: 10 more)", ylabel="share of subframes of 300 symbols")
        axes.set_ylim(LOWEST, 1.2)
        axes.legend(frameon=False, fontsize=8)
        figure.savefig(path, dpi=120, metadata={"Software": None})
