"""Picture of a recording's spectrum and levels."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from .signals import signal_spec

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .info import RecordingInfo


def figure_png(info: RecordingInfo) -> bytes:
    """PNG of the spectrum (with the signals that fit) above the level histogram."""
    figure = Figure(figsize=(9, 6), layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=[2, 1])
    _draw_spectrum(upper, info)
    _draw_levels(lower, info)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=120, metadata={"Software": None})
    return buffer.getvalue()


def _draw_spectrum(axes: Axes, info: RecordingInfo) -> None:
    axes.plot(info.spectrum.frequency_hz / 1e6, info.spectrum.density_db, lw=0.8)
    for offset_hz, names in sorted(_marks(info).items()):
        axes.axvline(offset_hz / 1e6, color="grey", lw=0.6, ls="--")
        label = " / ".join(sorted(names))
        axes.text(offset_hz / 1e6, axes.get_ylim()[1], label, rotation=90, va="top", size=8)
    axes.set(xlabel="frequency in the file, MHz", ylabel="power density, dB/Hz", title="Spectrum")
    axes.grid(alpha=0.3)


def _marks(info: RecordingInfo) -> dict[float, set[str]]:
    """Frequency in the file of every signal that fits, and the names found there."""
    marks: dict[float, set[str]] = {}
    for spec in map(signal_spec, info.signals):
        offset_hz = spec.carrier_hz - info.format.lo_hz
        place_hz = offset_hz if info.format.is_complex else abs(offset_hz)
        marks.setdefault(place_hz, set()).add(spec.composite)
    return marks


def _draw_levels(axes: Axes, info: RecordingInfo) -> None:
    axes.stairs(info.levels.counts, info.levels.edges, fill=True)
    axes.set(xlabel="sample value", ylabel="count", title="Levels")
