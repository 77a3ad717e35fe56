"""Spectrum of the recording with the signals' bands marked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sdr_spoof import _core
from sdr_spoof.report.chart import Axis, Drawing, Grid, Panel, drawing
from sdr_spoof.report.chart.marks import Note
from sdr_spoof.report.figures import style
from sdr_spoof.report.spectrum import Spectrum


def draw_spectrum(spectrum: Spectrum, signals: Sequence[str]) -> Drawing:
    """Bands of ``signals`` are shaded around their carriers."""
    rf_mhz = spectrum.rf_hz / 1e6
    top = float(np.max(spectrum.density_db))
    bottom = float(np.percentile(spectrum.density_db, 1))
    room = max(top - bottom, 3.0)
    panel = Panel(
        x=Axis("Radio frequency (MHz)", float(rf_mhz[0]), float(rf_mhz[-1])),
        y=Axis("Power density\n(dB re 1 LSB²/Hz)", bottom - 0.15 * room, top + 0.3 * room),
    )
    panel.line(rf_mhz, spectrum.density_db, style.INK, 1.0)
    for carrier_hz, name, half_hz, colour in _bands(signals):
        centre, half = carrier_hz / 1e6, half_hz / 1e6
        panel.shade(colour, 0.18, x=(centre - half, centre + half))
        panel.moment(centre, colour, 1.4)
        at = float((centre - rf_mhz[0]) / (rf_mhz[-1] - rf_mhz[0]))
        for number, line in enumerate((name, f"{centre:.7g}")):
            low = 14.0 + 15.0 * number
            panel.note(Note(at, 1.0, line, colour, 12.0, "start", True, True, (6.0, low)))
    return drawing(Grid([[panel]], [205.0]))


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
