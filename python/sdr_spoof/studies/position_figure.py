"""Figure of the errors of positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

COLOURS = ("#0072B2", "#009E73", "#E69F00", "#D55E00")


def draw(path: Path, errors: Mapping[str, NDArray[np.float64]]) -> None:
    """Horizontal error of each case over time."""
    with mpl.rc_context({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3}):
        figure = Figure(figsize=(7.5, 4.5), layout="constrained")
        axes = figure.subplots()
        for (name, error), colour in zip(errors.items(), COLOURS, strict=False):
            axes.semilogy(error[:, 0], np.hypot(error[:, 1], error[:, 2]), ".-", color=colour,
                          label=name, linewidth=0.8)  # fmt: skip
        axes.set(xlabel="time, s", ylabel="horizontal error, m")
        axes.legend(frameon=False, fontsize=8)
        figure.savefig(path, dpi=120, metadata={"Software": None})
