"""Per-satellite detail: carrier, code, lock and correlation shape of each of its signals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.figures import style

PLACES = {
    **{"left": 0.07, "right": 0.992, "bottom": 0.095, "top": 0.9},
    **{"wspace": 0.3, "hspace": 0.42},
}
"""Of the small multiples: this picture is drawn for every satellite, so it is not arranged anew."""
C_M_S = 299_792_458.0
SAMPLED_EPOCHS = 1 << 16
"""Of a longer track, 11 minutes of 10 ms, every n-th epoch is enough for a picture."""


def draw_satellite(tracks: Sequence[SignalTrack], onset_s: float | None, duration_s: float) -> str:
    """Small multiples over all signals of one satellite; ``onset_s`` splits before and after."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(2, 3, gridspec_kw=PLACES).ravel()
        middle = onset_s if onset_s is not None else duration_s / 2.0
        shown = [track.sampled(SAMPLED_EPOCHS) for track in tracks]
        course = _reference_course(shown, middle)
        for track in shown:
            held = track.state >= State.TRACKING
            if np.count_nonzero(held) < 10:
                continue
            colour = style.colour(track.signal)
            time = track.time_s
            _line(panels[0], time, doppler_residual_hz(track, course), held, colour, track.signal)
            _line(panels[1], time, code_minus_carrier_m(track, held), held, colour, track.signal)
            _line(panels[2], time, track.phase_lock, held, colour, track.signal)
            _line(panels[3], time, track.cn0_dbhz, held, colour, track.signal)
            for axes, part in (
                (panels[4], held & (time < middle)),
                (panels[5], held & (time >= middle)),
            ):
                _shape(axes, track, part, colour)
        _dress(panels, onset_s, duration_s)
        handles, names = panels[0].get_legend_handles_labels()
        if handles:
            figure.legend(handles, names, loc="upper right", ncols=4, borderaxespad=0.2)

    return style.render(draw, 10.0, 5.0, placed=True)


def _line(
    axes: Axes,
    time: NDArray[np.float64],
    values: NDArray[np.float64],
    held: NDArray[np.bool_],
    colour: str,
    name: str,
) -> None:
    shown = style.thinned(time, np.where(held, values, np.nan))
    axes.plot(*shown, color=colour, linewidth=0.9, label=name, alpha=0.9)


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


def _shape(axes: Axes, track: SignalTrack, part: NDArray[np.bool_], colour: str) -> None:
    if np.count_nonzero(part) < 10:
        return
    offset_m = track.tap_offsets_s * C_M_S
    order = np.argsort(offset_m)
    chip_m = C_M_S / _core.signal_spec(track.signal)["chip_rate_hz"]
    order = order[np.abs(offset_m[order]) < 1.5 * chip_m]  # taps further out measure noise
    shape = correlation_shape(track, part)
    axes.plot(offset_m[order], shape[order], "o-", color=colour, markersize=4)


def _dress(panels: Sequence[Axes], onset_s: float | None, duration_s: float) -> None:
    before, after = (
        ("before the onset", "after the onset") if onset_s is not None else ("1st half", "2nd half")
    )
    titles = (
        ("Doppler off the common course", "Hz"),
        ("Code minus carrier", "m"),
        ("Phase lock, 1 = locked", "mean cos(2φ)"),
        ("Signal strength", "C/N0 (dB-Hz)"),
        (f"Correlation, {before}", "Relative to prompt"),
        (f"Correlation, {after}", "Relative to prompt"),
    )
    for axes, (title, unit) in zip(panels, titles, strict=True):
        axes.set_title(title)
        axes.set_ylabel(unit)
    for axes in panels[:4]:
        axes.set_xlim(0, duration_s)
        axes.set_xlabel("Time (s)")
        if onset_s is not None:
            axes.axvline(onset_s, color=style.ALARM, linewidth=1.4)
    panels[2].set_ylim(-0.25, 1.1)
    for axes in panels[4:]:
        axes.set_xlabel("Tap delay (m, positive = late)")
        axes.set_ylim(-0.6, 1.1)
