"""Spectrum of the recording with the signals' bands marked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.signals import signal_spec

from . import style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .sheet import Sheets

PLACES = {"left": 0.078, "right": 0.988, "bottom": 0.165, "top": 0.985}
Band = tuple[float, str, float, str]
"""Carrier in Hz, names, widest half bandwidth in Hz, colour."""


@dataclass(frozen=True)
class SpectrumDrawing:
    """Power density over radio frequency; bands of ``signals`` are shaded around their carriers."""

    rf_hz: NDArray[np.float64]
    density_db: NDArray[np.float64]
    signals: tuple[str, ...]

    def png(self, _: Sheets) -> bytes:
        """The picture."""
        return style.png(self._draw, 10.0, 3.0, placed=True)

    def _draw(self, figure: Figure) -> None:
        axes = figure.subplots(gridspec_kw=PLACES)
        rf_mhz = self.rf_hz / 1e6
        axes.plot(rf_mhz, self.density_db, color=style.INK, linewidth=0.7)
        top = float(np.max(self.density_db))
        bottom = float(np.percentile(self.density_db, 1))
        room = max(top - bottom, 3.0)
        axes.set_ylim(bottom - 0.15 * room, top + 0.3 * room)
        axes.set_xlim(float(rf_mhz[0]), float(rf_mhz[-1]))
        for band in _bands(self.signals):
            _mark(axes, band)
        axes.set_xlabel("Radio frequency (MHz)")
        axes.set_ylabel("Power density\n(dB re 1 LSB²/Hz)")


def _mark(axes: Axes, band: Band) -> None:
    carrier_hz, name, half_hz, colour = band
    centre, half = carrier_hz / 1e6, half_hz / 1e6
    axes.axvspan(centre - half, centre + half, color=colour, alpha=0.18, linewidth=0)
    axes.axvline(centre, color=colour, linewidth=1.0)
    axes.annotate(
        f"{name}\n{centre:.7g}",
        (centre, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(4, -4),
        textcoords="offset points",
        va="top",
        color=colour,
        fontweight="bold",
        fontsize=9,
    )


def _bands(signals: Sequence[str]) -> list[Band]:
    """One band per carrier."""
    found: dict[float, tuple[list[str], float, str]] = {}
    for spec in map(signal_spec, signals):
        names, half, colour = found.get(spec.carrier_hz, ([], 0.0, style.colour(spec.id)))
        if spec.composite not in names:
            names = [*names, spec.composite]
        found[spec.carrier_hz] = (names, max(half, spec.min_half_bandwidth_hz), colour)
    return [(hz, " + ".join(n), half, c) for hz, (n, half, c) in sorted(found.items())]
