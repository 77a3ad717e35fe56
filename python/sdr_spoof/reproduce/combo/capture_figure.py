"""Picture of a captured loop's phase against both capture models."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.detectors import combo_model as model
from sdr_spoof.report.figures import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def draw_capture(time_s: Floats, phase_cycles: Floats, drag_hz: float, eta: float) -> bytes:
    """Phase of one run, with the sum of both phasors and the small-angle line; PNG."""
    beat = drag_hz * time_s
    total = np.unwrap(model.capture_phase_cycles(beat, eta), period=1.0)
    small = model.capture_phase_small_angle_cycles(beat, eta)

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2, width_ratios=(3, 2))
        for axes in (left, right):
            axes.plot(time_s, phase_cycles, color="#0072b2", label="loop, measured phase")
            axes.plot(time_s, total, color=style.INK, lw=1.0, label="phase of the sum (beat)")
            axes.plot(time_s, small, color=style.ALARM, ls="--", label="small angle, as published")
            axes.set(xlabel="time since the start of the drag (s)", ylabel="phase (cycles)")
        left.set_title("The mean rate is f_e, not eta / (1 + eta) f_e")
        left.legend(loc="upper left")
        right.set_title("First beat")
        right.set(xlim=(0.0, 1.0 / drag_hz), ylim=(-0.1, 1.1))

    return style.png(draw, 9.6, 3.8)
