"""Per-satellite detail: carrier, code, lock and correlation shape of each of its signals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.chart import Axis, Drawing, Entry, Grid, Panel, drawing
from sdr_spoof.report.figures import style

C_M_S = 299_792_458.0
SAMPLED_EPOCHS = 1 << 16
"""Of a longer track, 11 minutes of 10 ms, every n-th epoch is enough for a picture."""


def draw_satellite(
    tracks: Sequence[SignalTrack], onset_s: float | None, duration_s: float
) -> Drawing:
    """Small multiples over all signals of one satellite; ``onset_s`` splits before and after."""
    panels = _panels(onset_s, duration_s)
    middle = onset_s if onset_s is not None else duration_s / 2.0
    shown = [track.sampled(SAMPLED_EPOCHS) for track in tracks]
    course = _reference_course(shown, middle)
    legend = []
    for track in shown:
        held = track.state >= State.TRACKING
        if np.count_nonzero(held) < 10:
            continue
        colour, time = style.colour(track.signal), track.time_s
        courses = (
            doppler_residual_hz(track, course),
            code_minus_carrier_m(track, held),
            track.phase_lock,
            track.cn0_dbhz,
        )
        for panel, values in zip(panels[:4], courses, strict=True):
            panel.line(time, np.where(held, values, np.nan), colour, 1.2, opacity=0.9)
        _shape(panels[4], track, held & (time < middle), colour)
        _shape(panels[5], track, held & (time >= middle), colour)
        legend.append(Entry(track.signal, colour))
    return drawing(Grid([panels[:3], panels[3:]], heights=[155.0, 155.0]), legend=legend)


def _panels(onset_s: float | None, duration_s: float) -> list[Panel]:
    before, after = (
        ("before the onset", "after the onset") if onset_s is not None else ("1st half", "2nd half")
    )
    courses = (
        ("Doppler off the common course", Axis("Hz")),
        ("Code minus carrier", Axis("m")),
        ("Phase lock, 1 = locked", Axis("mean cos(2φ)", -0.25, 1.1)),
        ("Signal strength", Axis("C/N0 (dB-Hz)")),
    )
    panels = [Panel(title, Axis("Time (s)", 0.0, duration_s), y) for title, y in courses]
    if onset_s is not None:
        for panel in panels:
            panel.moment(onset_s, style.ALARM, 1.8)
    delay = "Tap delay (m, positive = late)"
    return panels + [
        Panel(f"Correlation, {part}", Axis(delay), Axis("Relative to prompt", -0.6, 1.1))
        for part in (before, after)
    ]


def _reference_course(tracks: Sequence[SignalTrack], until_s: float) -> NDArray[np.float64]:
    """Line through the first signal's relative Doppler (Doppler / carrier) before ``until_s``."""
    for track in tracks:
        part = (track.state >= State.TRACKING) & (track.time_s < until_s)
        if np.count_nonzero(part) >= 10:
            relative = track.doppler_hz / _core.signal_spec(track.signal)["carrier_hz"]
            return np.polyfit(track.time_s[part], relative[part], 1)
    return np.zeros(2)


def doppler_residual_hz(track: SignalTrack, course: NDArray[np.float64]) -> NDArray[np.float64]:
    """Doppler minus the satellite's common course, scaled to the signal's carrier, in Hz."""
    carrier_hz = _core.signal_spec(track.signal)["carrier_hz"]
    return np.asarray(track.doppler_hz - carrier_hz * np.polyval(course, track.time_s))


def code_minus_carrier_m(track: SignalTrack, held: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Range by code minus range by carrier phase in m; each unbroken piece starts at zero."""
    spec = _core.signal_spec(track.signal)
    code_m = C_M_S * (track.time_s - track.code_phase_chips / spec["chip_rate_hz"])
    difference = code_m - track.carrier_phase_cycles * C_M_S / spec["carrier_hz"]
    rows = np.flatnonzero(held)
    # After a loss of lock both phases start anew.
    for piece in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
        difference[piece] -= np.median(difference[piece[:50]]) if piece.size else 0.0
    return np.asarray(difference)


def correlation_shape(track: SignalTrack, part: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Mean taps in phase with the prompt, relative to the mean prompt, shape (taps,)."""
    taps = track.taps[part].astype(np.complex128)
    prompt = taps[:, track.prompt_tap]
    turned = (taps * np.conj(prompt / np.maximum(np.abs(prompt), 1e-30))[:, None]).real.mean(axis=0)
    return np.asarray(turned / max(float(turned[track.prompt_tap]), 1e-30))


def _shape(panel: Panel, track: SignalTrack, part: NDArray[np.bool_], colour: str) -> None:
    if np.count_nonzero(part) < 10:
        return
    offset_m = track.tap_offsets_s * C_M_S
    order = np.argsort(offset_m)
    chip_m = C_M_S / _core.signal_spec(track.signal)["chip_rate_hz"]
    order = order[np.abs(offset_m[order]) < 1.5 * chip_m]  # taps further out measure noise
    shape = correlation_shape(track, part)
    panel.line(offset_m[order], shape[order], colour)
    panel.dots(offset_m[order], shape[order], colour, 5.5)
