"""What rate a loop really takes: the beat model against the published small-angle model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.detectors import combo_model as model
from sdr_spoof.reproduce.study import Number, Picture, Section, Table

from . import published
from .capture_figure import draw_capture
from .tap_loops import B1C, EPOCH_S, Rays, WindowSlope, follow

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    from .tap_loops import Epoch

    Floats = NDArray[np.float64]

SEED = 20_180_004
CN0_DBHZ = 30.0
DRAGS_HZ = (1.0, 2.0, 5.0, 10.0)
SIMULATED_HZ = (1.0, 2.1, 5.0, 10.1)
"""End slopes that another simulation found (one run each)."""
DURATION_S = 6.0
WINDOW_S = 2.0
SHOWN_HZ = 1.0
LEAST_RUNS = 100


def simulate(
    drags_hz: Floats, etas: Floats, seed: int, duration_s: float = DURATION_S
) -> tuple[Floats, Floats]:
    """Phase of the loop, shape (epochs, runs), and its slopes by windows, for a drag from 0 s."""
    epochs = round(duration_s / EPOCH_S)
    slopes = WindowSlope(drags_hz.size, epochs, round(WINDOW_S / EPOCH_S))
    phase = np.zeros((epochs, drags_hz.size))

    def rays(time_s: float) -> Rays:
        return Rays(etas, -drags_hz * time_s * 0.19029, drags_hz * time_s, drags_hz)

    def each(epoch: int, got: Epoch) -> None:
        phase[epoch] = got.phase_cycles
        slopes.add(epoch, got.phase_cycles)

    follow(B1C, CN0_DBHZ, drags_hz.size, epochs, rays, seed, each)
    return phase, slopes.slope_hz


def section(effort: Effort, stages: Stages) -> Section:
    """End slopes of four drags, against both capture models."""
    runs = max(LEAST_RUNS, effort.runs)
    with stages("Capture models"):
        drags = np.repeat(DRAGS_HZ, runs)
        phase, slopes = simulate(drags, np.full(drags.size, published.ETA), SEED)
    ends = slopes[-1].reshape(len(DRAGS_HZ), runs)
    shown = phase[:, DRAGS_HZ.index(SHOWN_HZ) * runs]
    time_s = np.arange(0.5, phase.shape[0]) * EPOCH_S
    png = draw_capture(time_s, shown, SHOWN_HZ, published.ETA)
    return Section(
        "The rate under an attack: beat, not small angle",
        text=(
            "Equations 13 and 17 put the rate of a captured loop at eta / (1 + eta) f_e, which "
            "holds only while both phase errors are small. With eta over 1 the loop follows the "
            "stronger phasor: the mean rate is f_e, and a beat of the sum rides on it. The "
            "published shift is the slope of the first instant, at which both are in phase.",
        ),
        tables=[_table(ends)],
        pictures=[
            Picture(
                "capture",
                "Phase of a captured loop",
                png,
                f"One run at {CN0_DBHZ:g} dB-Hz, eta {published.ETA:g}, drag {SHOWN_HZ:g} Hz: the "
                "loop follows the phase of the sum of both signals, whose mean rate is f_e.",
            )
        ],
        numbers=_numbers(ends),
    )


def _table(ends: Floats) -> Table:
    rows: list[Sequence[Cell]] = []
    for drag, simulated, slopes in zip(DRAGS_HZ, SIMULATED_HZ, ends, strict=True):
        rows.append(
            (
                drag,
                float(model.capture_rate_small_angle_hz(drag, published.ETA)),
                float(model.capture_rate_mean_hz(drag, published.ETA)),
                float(slopes.mean()),
                float(slopes.std(ddof=1)),
                float(slopes[0]),
                simulated,
            )
        )
    columns = (
        "drag f_e (Hz)",
        "small angle (Hz)",
        "beat model, mean (Hz)",
        "loops, mean end slope (Hz)",
        "standard deviation (Hz)",
        "first run (Hz)",
        "another simulation (Hz)",
    )
    return Table(
        "end_slopes",
        f"End slopes at eta 1.5 and {CN0_DBHZ:g} dB-Hz",
        columns,
        rows,
        f"Slope over the last {WINDOW_S:g} of {DURATION_S:g} s, {ends.shape[1]} runs a drag, "
        "code dragged with the carrier.",
    )


def _numbers(ends: Floats) -> list[Number]:
    numbers = []
    for drag, simulated, slopes in zip(DRAGS_HZ, SIMULATED_HZ, ends, strict=True):
        what = f"end slope of the captured loop at a drag of {drag:g} Hz"
        # The other simulation rounds to 0.1 Hz and has one run: 0.15 Hz on either side.
        numbers.append(
            Number(
                f"end_slope_{drag:g}_hz",
                what,
                float(slopes.mean()),
                simulated - 0.15,
                simulated + 0.15,
                "Hz",
                simulated,
            )
        )
    return numbers
