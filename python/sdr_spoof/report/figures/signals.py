"""Acquisition overview and C/N0 over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.records import Acquisition, SignalTrack, State, TrackLog
from sdr_spoof.signals import satellite_name, system_of

from . import style
from .satellite import SAMPLED_EPOCHS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .sheet import Sheets

MOST_LEVEL_NAMES = 12
"""Names of satellites that have room beside each other."""


@dataclass(frozen=True)
class AcquisitionDrawing:
    """Bars of C/N0 and marks of Doppler per satellite and signal."""

    found: tuple[Acquisition, ...]
    """Detected ones."""

    @classmethod
    def of(cls, acquisitions: Iterable[Acquisition]) -> AcquisitionDrawing:
        """Of what was detected."""
        return cls(tuple(a for a in acquisitions if a.detected))

    def png(self, _: Sheets) -> bytes:
        """The picture."""
        return style.png(self._draw, 10.0, 3.3, placed=True)

    def _draw(self, figure: Figure) -> None:
        satellites = sorted({(system_of(a.signal), a.prn) for a in self.found})
        upright = len(satellites) > MOST_LEVEL_NAMES
        places = {
            **{"left": 0.062, "right": 0.992, "top": 0.83, "wspace": 0.19},
            "bottom": 0.14 if upright else 0.085,
        }
        strength, doppler = figure.subplots(1, 2, gridspec_kw=places)
        self._bars(strength, doppler, satellites)
        for axes in (strength, doppler):
            axes.set_xticks(range(len(satellites)), [satellite_name(*s) for s in satellites])
            axes.grid(visible=False, axis="x")
            if upright:
                axes.tick_params(axis="x", rotation=90)
        lowest = min((a.cn0_dbhz for a in self.found), default=30.0)
        strength.set_ylim(min(30.0, lowest - 3.0), None)
        strength.set_ylabel("C/N0 (dB-Hz)")
        strength.set_title("Signal strength at acquisition")
        doppler.axhline(0, color=style.MUTED, linewidth=0.8)
        doppler.set_ylabel("Doppler (Hz)")
        doppler.set_title("Doppler at acquisition")
        if self.found:
            figure.legend(*strength.get_legend_handles_labels(), loc="upper right", ncols=4)

    def _bars(self, strength: Axes, doppler: Axes, satellites: Sequence[tuple[str, int]]) -> None:
        signals = list(dict.fromkeys(a.signal for a in self.found))
        width = 0.8 / max(len(signals), 1)
        for number, signal in enumerate(signals):
            rows = [a for a in self.found if a.signal == signal]
            at = np.array([satellites.index((system_of(a.signal), a.prn)) for a in rows])
            at = at + (number - (len(signals) - 1) / 2) * width
            colour = style.colour(signal)
            strength.bar(at, [a.cn0_dbhz for a in rows], width * 0.92, color=colour, label=signal)
            doppler.vlines(at, 0, [a.doppler_hz for a in rows], color=colour, linewidth=1.5)
            doppler.plot(at, [a.doppler_hz for a in rows], "o", color=colour, markersize=5)


@dataclass(frozen=True)
class Cn0Line:
    """One track."""

    signal: str
    name: str
    colour: str | None
    """Of what was found; None where nothing was."""
    time_s: NDArray[np.float64]
    cn0_dbhz: NDArray[np.float64]
    end_dbhz: float
    """Where its name stands."""

    @classmethod
    def of(cls, track: SignalTrack, verdict: str) -> Cn0Line | None:
        """Thinned; None if it was never held."""
        track = track.sampled(SAMPLED_EPOCHS)
        held, cn0 = track.state >= State.TRACKING, track.cn0_dbhz
        if not held.any():
            return None
        name = satellite_name(system_of(track.signal), track.prn)
        line = style.thinned(track.time_s, np.where(held, cn0, np.nan))
        end_dbhz = float(np.median(cn0[held][-200:]))
        return cls(track.signal, name, style.VERDICTS.get(verdict), *line, end_dbhz)


@dataclass(frozen=True)
class Cn0Drawing:
    """C/N0 over time, one panel per signal; red: spoofed, amber: suspect, grey: all others."""

    signals: tuple[str, ...]
    lines: tuple[Cn0Line, ...]
    duration_s: float

    @classmethod
    def of(cls, log: TrackLog, verdicts: Mapping[tuple[str, int], str]) -> Cn0Drawing:
        """Of all tracks."""
        signals = dict.fromkeys(t.signal for t in log.signals)
        lines = (Cn0Line.of(t, verdicts.get((system_of(t.signal), t.prn), "")) for t in log.signals)
        return cls(tuple(signals), tuple(line for line in lines if line), log.duration_s)

    def png(self, _: Sheets) -> bytes:
        """The picture."""
        return style.png(self._draw, 10.0, 3.2, placed=True)

    def _draw(self, figure: Figure) -> None:
        places = {"left": 0.06, "right": 0.995, "bottom": 0.15, "top": 0.925, "wspace": 0.05}
        count = max(len(self.signals), 1)
        panels = figure.subplots(1, count, sharey=True, squeeze=False, gridspec_kw=places)[0]
        by_signal = [[e for e in self.lines if e.signal == signal] for signal in self.signals]
        for axes, signal, lines in zip(panels, self.signals, by_signal, strict=False):
            for line in lines:
                _draw_cn0(axes, line)
            axes.set_title(signal)
            axes.set_xlabel("Time (s)")
            axes.set_xlim(0, self.duration_s * 1.06)
        panels[0].set_ylabel("C/N0 (dB-Hz)")
        for axes, lines in zip(panels, by_signal, strict=False):  # after all lines: one scale
            ends = [(e.end_dbhz, e.name, e.colour or style.MUTED) for e in lines]
            _name_lines(axes, ends, self.duration_s)


def _draw_cn0(axes: Axes, line: Cn0Line) -> None:
    found = line.colour is not None
    axes.plot(
        line.time_s,
        line.cn0_dbhz,
        color=line.colour or "#a9b2bb",
        linewidth=1.8 if found else 1.0,
        zorder=3 if found else 2,
    )


def _name_lines(axes: Axes, ends: list[tuple[float, str, str]], time_s: float) -> None:
    """Writes names at the right end of the lines, moved apart so that none overlap."""
    low, high = axes.get_ylim()
    ends = sorted(ends)
    spacing = min(0.055, 1.0 / max(len(ends), 1)) * (high - low)
    places = [cn0 for cn0, _, _ in ends]
    for i in range(1, len(places)):
        places[i] = max(places[i], places[i - 1] + spacing)
    room = high
    for i in reversed(range(len(places))):  # push back down what stands out at the top
        places[i] = min(places[i], room)
        room = places[i] - spacing
    size = 8 if len(ends) <= 18 else 6.5
    for at, (_, name, colour) in zip(places, ends, strict=True):
        axes.text(time_s, at, f" {name}", va="center", fontsize=size, color=colour)
