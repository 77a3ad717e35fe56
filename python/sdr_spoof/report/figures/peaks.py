"""The correlation peak before, during and after a capture, as small multiples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.figures import style
from sdr_spoof.signals import signal_spec

AROUND_S = 2.0
"""Length of the stretches before and after."""
DURING_S = 20.0
"""Longest stretch that counts as during the change."""
LEAST_EPOCHS = 5


@dataclass(frozen=True)
class Stretch:
    """A stretch of the recording and its name."""

    name: str
    start_s: float
    stop_s: float


def stretches(onset_s: float, last_alarm_s: float, duration_s: float) -> tuple[Stretch, ...]:
    """Before the onset, from there to the last alarm or so, and the end of the recording."""
    change_s = min(max(last_alarm_s, onset_s + 0.5), onset_s + DURING_S, duration_s)
    late_s = max(change_s, duration_s - AROUND_S)
    if duration_s - late_s < 0.25:  # the alarm came with the end
        late_s = change_s = onset_s + 0.6 * (duration_s - onset_s)
    return (
        Stretch("before", max(onset_s - AROUND_S, 0.0), onset_s),
        Stretch("during", onset_s, change_s),
        Stretch("after", late_s, duration_s),
    )


@dataclass(frozen=True)
class Peak:
    """Mean taps in phase with the prompt, K taps around it."""

    offset_chips: NDArray[np.float64]
    height: NDArray[np.float64]
    """Input units per sample."""


def peak(track: SignalTrack, stretch: Stretch) -> Peak | None:
    """The peak of a stretch, each epoch turned by its prompt's phase; None if it was not held."""
    part = track.between(stretch.start_s, stretch.stop_s)
    held = part.state >= State.TRACKING
    if np.count_nonzero(held) < LEAST_EPOCHS:
        return None
    taps = part.taps[held].astype(np.complex128) / part.integration_s[held][:, None]
    prompt = taps[:, track.prompt_tap]
    turn = np.conj(prompt) / np.maximum(np.abs(prompt), 1e-30)
    height = (taps * turn[:, None]).real.mean(axis=0)
    offset = track.tap_offsets_s * signal_spec(track.signal).chip_rate_hz
    order = np.argsort(offset)
    order = order[np.abs(offset[order]) < 1.5]  # taps further out measure noise
    return Peak(offset[order], height[order])


def draw_peaks(
    panels: Sequence[Axes], track: SignalTrack, parts: Sequence[Stretch], *, captured: bool
) -> None:
    """One panel per stretch, relative to the peak before, which stays in grey."""
    peaks = [peak(track, part) for part in parts]
    first = next((p for p in peaks if p is not None), None)
    scale = float(first.height.max()) if first is not None else 1.0
    name = signal_spec(track.signal).composite
    for axes, part, found in zip(panels, parts, peaks, strict=True):
        if first is not None and found is not first:
            axes.plot(first.offset_chips, first.height / scale, "o-", color="#b3bbc3", markersize=3)
        if found is not None:
            colour = (
                style.ALARM if captured and part.name == "after" else style.colour(track.signal)
            )
            axes.plot(found.offset_chips, found.height / scale, "o-", color=colour, markersize=4)
        else:
            axes.text(0.5, 0.5, "not held", ha="center", va="center", transform=axes.transAxes)
        axes.xaxis.set_major_locator(MultipleLocator(0.5))
        axes.set_title(
            f"{name} {part.name}\n{part.start_s:.1f}–{part.stop_s:.1f} s",
            fontsize=8.5,
            fontweight="normal",
        )
