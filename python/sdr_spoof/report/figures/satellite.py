"""Per-satellite detail: carrier, code, lock and correlation shape of each of its signals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.records import SignalTrack, State
from sdr_spoof.signals import LIGHT_M_S, signal_spec

from . import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .sheet import Sheets

PLACES = {
    **{"left": 0.07, "right": 0.987, "bottom": 0.095, "top": 0.9},
    **{"wspace": 0.3, "hspace": 0.42},
}
SAMPLED_EPOCHS = 1 << 16
"""Of a longer track, 11 minutes of 10 ms, every n-th epoch is enough for a picture."""
PANEL_POINTS = 1600
"""Points of a line in a panel 420 pixels wide."""
LEAST_EPOCHS = 10
Line = tuple["NDArray[np.float64]", "NDArray[np.float64]"]


@dataclass(frozen=True)
class SatelliteFrame:
    """What the small multiples of all satellites with the same signals share."""

    signals: tuple[str, ...]
    duration_s: float
    halves: tuple[str, str]
    """Names of the stretches whose correlation is drawn."""
    reach_m: tuple[float, float]
    """Delays of the first and the last tap."""

    @property
    def size_in(self) -> tuple[float, float]:
        """Width and height in inches."""
        return 10.0, 5.0

    def build(self, figure: Figure) -> None:
        """Two rows of three panels."""
        panels = figure.subplots(2, 3, gridspec_kw=PLACES).ravel()
        titles = (
            ("Doppler off the common course", "Hz"),
            ("Code minus carrier", "m"),
            ("Phase lock, 1 = locked", "mean cos(2φ)"),
            ("Signal strength", "C/N0 (dB-Hz)"),
            *((f"Correlation, {half}", "Relative to prompt") for half in self.halves),
        )
        for axes, (title, unit) in zip(panels, titles, strict=True):
            axes.set_title(title)
            axes.set_ylabel(unit)
        for axes in panels[:4]:
            axes.set_xlim(0, self.duration_s)
            axes.set_xlabel("Time (s)")
        panels[2].set_ylim(-0.25, 1.1)
        margin_m = 0.05 * (self.reach_m[1] - self.reach_m[0])
        for axes in panels[4:]:
            axes.set_xlim(self.reach_m[0] - margin_m, self.reach_m[1] + margin_m)
            axes.set_xlabel("Tap delay (m, positive = late)")
            axes.set_ylim(-0.6, 1.1)
        handles = [style.sample(style.colour(signal)) for signal in self.signals]
        if handles:
            figure.legend(handles, self.signals, loc="upper right", ncols=4, borderaxespad=0.2)


@dataclass(frozen=True)
class SatelliteDrawing:
    """Small multiples over all signals of one satellite, thinned."""

    frame: SatelliteFrame
    lines: tuple[tuple[Line, ...], ...]
    """Of each signal, one for each of the first four panels."""
    shapes: tuple[tuple[Line | None, ...], ...]
    """Of each signal, one for each half: tap delay in m, mean tap relative to the prompt."""
    onset_s: float | None

    @classmethod
    def of(
        cls, tracks: Sequence[SignalTrack], onset_s: float | None, duration_s: float
    ) -> SatelliteDrawing:
        """Of a satellite's tracks; ``onset_s`` splits before and after."""
        middle_s = onset_s if onset_s is not None else duration_s / 2.0
        parted = onset_s is not None
        halves = ("before the onset", "after the onset") if parted else ("1st half", "2nd half")
        sampled = [track.sampled(SAMPLED_EPOCHS) for track in tracks]
        shown = [t for t in sampled if np.count_nonzero(_held(t)) >= LEAST_EPOCHS]
        course = _reference_course(shown, middle_s)
        delays_m = [_near_taps(t)[1] for t in shown] or [np.array([-1.0, 1.0])]
        reach_m = min(float(d[0]) for d in delays_m), max(float(d[-1]) for d in delays_m)
        frame = SatelliteFrame(tuple(t.signal for t in shown), duration_s, halves, reach_m)
        lines = tuple(_lines(track, course) for track in shown)
        shapes = tuple(_shapes(track, middle_s) for track in shown)
        return cls(frame, lines, shapes, onset_s)

    def png(self, sheets: Sheets) -> bytes:
        """The picture."""
        return sheets.of(self.frame).png(self._fill)

    def _fill(self, panels: Sequence[Axes]) -> None:
        for signal, lines, shapes in zip(self.frame.signals, self.lines, self.shapes, strict=True):
            colour = style.colour(signal)
            for axes, line in zip(panels[:4], lines, strict=True):
                axes.plot(*line, color=colour, linewidth=0.9, alpha=0.9)
            for axes, shape in zip(panels[4:], shapes, strict=True):
                if shape is not None:
                    axes.plot(*shape, "o-", color=colour, markersize=4)
        if self.onset_s is not None:
            for axes in panels[:4]:
                axes.axvline(self.onset_s, color=style.ALARM, linewidth=1.4)


def _held(track: SignalTrack) -> NDArray[np.bool_]:
    return track.state >= State.TRACKING


def _lines(track: SignalTrack, course: NDArray[np.float64]) -> tuple[Line, ...]:
    held = _held(track)
    columns = (
        doppler_residual_hz(track, course),
        code_minus_carrier_m(track, held),
        track.phase_lock,
        track.cn0_dbhz,
    )
    shown = (np.where(held, values, np.nan) for values in columns)
    return tuple(style.thinned(track.time_s, values, PANEL_POINTS) for values in shown)


def _shapes(track: SignalTrack, middle_s: float) -> tuple[Line | None, ...]:
    """Before and after; None where the signal was hardly held."""
    order, delay_m = _near_taps(track)
    before = track.time_s < middle_s
    parts = (_held(track) & before, _held(track) & ~before)
    return tuple(
        (delay_m, correlation_shape(track, part)[order])
        if np.count_nonzero(part) >= LEAST_EPOCHS
        else None
        for part in parts
    )


def _near_taps(track: SignalTrack) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Order of the taps by delay, and their delays in m; those further out measure noise."""
    offset_m = track.tap_offsets_s * LIGHT_M_S
    order = np.argsort(offset_m)
    order = order[
        np.abs(offset_m[order]) < 1.5 * LIGHT_M_S / signal_spec(track.signal).chip_rate_hz
    ]
    return order, offset_m[order]


def _reference_course(tracks: Sequence[SignalTrack], until_s: float) -> NDArray[np.float64]:
    """Line through the first signal's relative Doppler (Doppler / carrier) before ``until_s``."""
    for track in tracks:
        part = _held(track) & (track.time_s < until_s)
        if np.count_nonzero(part) >= LEAST_EPOCHS:
            relative = track.doppler_hz / signal_spec(track.signal).carrier_hz
            return np.polyfit(track.time_s[part], relative[part], 1)
    return np.zeros(2)


def doppler_residual_hz(track: SignalTrack, course: NDArray[np.float64]) -> NDArray[np.float64]:
    """Doppler minus the satellite's common course, scaled to the signal's carrier, in Hz."""
    carrier_hz = signal_spec(track.signal).carrier_hz
    return np.asarray(track.doppler_hz - carrier_hz * np.polyval(course, track.time_s))


def code_minus_carrier_m(track: SignalTrack, held: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Range by code minus range by carrier phase in m; each unbroken piece starts at zero."""
    spec = signal_spec(track.signal)
    code_m = LIGHT_M_S * (track.time_s - track.code_phase_chips / spec.chip_rate_hz)
    difference = code_m - track.carrier_phase_cycles * LIGHT_M_S / spec.carrier_hz
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
