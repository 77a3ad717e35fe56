"""Spectrum of the recording with the signals' bands marked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from sdr_spoof import _core
from sdr_spoof.report.figures import style
from sdr_spoof.report.spectrum import Spectrum


def draw_spectrum(spectrum: Spectrum, signals: Sequence[str]) -> str:
    """PNG data URI; bands of ``signals`` are shaded around their carriers."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        rf_mhz = spectrum.rf_hz / 1e6
        axes.plot(rf_mhz, spectrum.density_db, color=style.INK, linewidth=0.7)
        top = float(np.max(spectrum.density_db))
        bottom = float(np.percentile(spectrum.density_db, 1))
        room = max(top - bottom, 3.0)
        axes.set_ylim(bottom - 0.15 * room, top + 0.3 * room)
        axes.set_xlim(float(rf_mhz[0]), float(rf_mhz[-1]))
        for carrier_hz, name, half_hz, colour in _bands(signals):
            centre = carrier_hz / 1e6
            axes.axvspan(
                centre - half_hz / 1e6,
                centre + half_hz / 1e6,
                color=colour,
                alpha=0.18,
                linewidth=0,
            )
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
        axes.set_xlabel("Radio frequency (MHz)")
        axes.set_ylabel("Power density\n(dB re 1 LSB²/Hz)")

    return style.render(draw, 10.0, 3.0)


def _bands(signals: Sequence[str]) -> list[tuple[float, str, float, str]]:
    """One band per carrier: (carrier, names, widest half bandwidth, colour)."""
    found: dict[float, tuple[list[str], float, str]] = {}
    for signal in signals:
        spec = _core.signal_spec(signal)
        names, half, colour = found.get(spec["carrier_hz"], ([], 0.0, style.colour(signal)))
        if spec["composite"] not in names:
            names = [*names, spec["composite"]]
        half = max(half, spec["min_half_bandwidth_hz"])
        found[spec["carrier_hz"]] = (names, half, colour)
    return [(hz, " + ".join(n), half, c) for hz, (n, half, c) in sorted(found.items())]
