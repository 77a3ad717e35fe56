"""Acquisition overview and C/N0 over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sdr_spoof.records import Acquisition, SignalTrack, State, TrackLog
from sdr_spoof.report.figures import style
from sdr_spoof.report.figures.satellite import SAMPLED_EPOCHS
from sdr_spoof.report.words import satellite_name
from sdr_spoof.signals import system_of


def draw_acquisition(acquisitions: Sequence[Acquisition]) -> str:
    """Bars of C/N0 and marks of Doppler per satellite and signal; detected ones only."""
    found = [a for a in acquisitions if a.detected]
    satellites = sorted({(system_of(a.signal), a.prn) for a in found})
    signals = list(dict.fromkeys(a.signal for a in found))
    width = 0.8 / max(len(signals), 1)

    def draw(figure: Figure) -> None:
        strength, doppler = figure.subplots(1, 2)
        for number, signal in enumerate(signals):
            rows = [a for a in found if a.signal == signal]
            at = np.array([satellites.index((system_of(a.signal), a.prn)) for a in rows])
            at = at + (number - (len(signals) - 1) / 2) * width
            colour = style.colour(signal)
            strength.bar(at, [a.cn0_dbhz for a in rows], width * 0.92, color=colour, label=signal)
            doppler.vlines(at, 0, [a.doppler_hz for a in rows], color=colour, linewidth=1.5)
            doppler.plot(at, [a.doppler_hz for a in rows], "o", color=colour, markersize=5)
        for axes in (strength, doppler):
            axes.set_xticks(range(len(satellites)), [satellite_name(*s) for s in satellites])
            axes.grid(visible=False, axis="x")
            if len(satellites) > 12:
                axes.tick_params(axis="x", rotation=90)
        lowest = min((a.cn0_dbhz for a in found), default=30.0)
        strength.set_ylim(min(30.0, lowest - 3.0), None)
        strength.set_ylabel("C/N0 (dB-Hz)")
        strength.set_title("Signal strength at acquisition")
        doppler.axhline(0, color=style.MUTED, linewidth=0.8)
        doppler.set_ylabel("Doppler (Hz)")
        doppler.set_title("Doppler at acquisition")
        if signals:
            figure.legend(*strength.get_legend_handles_labels(), loc="outside upper right", ncols=4)

    return style.render(draw, 10.0, 3.3)


def draw_cn0(log: TrackLog, verdicts: Mapping[tuple[str, int], str]) -> str:
    """C/N0 over time, one panel per signal; red: spoofed, amber: suspect, grey: all others."""
    signals = list(dict.fromkeys(t.signal for t in log.signals))

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, max(len(signals), 1), sharey=True, squeeze=False)[0]
        names: list[list[tuple[float, str, str]]] = []
        for axes, signal in zip(panels, signals, strict=False):
            tracks = [t for t in log.signals if t.signal == signal]
            ends = []
            for track in tracks:
                colour = style.VERDICTS.get(verdicts.get((system_of(signal), track.prn), ""))
                end = _cn0_line(axes, track, colour or "#a9b2bb", colour is not None)
                if end is not None:
                    name = satellite_name(system_of(signal), track.prn)
                    ends.append((end, name, colour or style.MUTED))
            names.append(ends)
            axes.set_title(signal)
            axes.set_xlabel("Time (s)")
            axes.set_xlim(0, log.duration_s * 1.06)
        panels[0].set_ylabel("C/N0 (dB-Hz)")
        for axes, ends in zip(panels, names, strict=False):  # after all lines: one common scale
            _name_lines(axes, ends, log.duration_s)

    return style.render(draw, 10.0, 3.2)


def _cn0_line(axes: Axes, track: SignalTrack, colour: str, emphasised: bool) -> float | None:
    """Draws a track; returns the C/N0 at which it ends, None if it was never held."""
    track = track.sampled(SAMPLED_EPOCHS)
    held, cn0 = track.state >= State.TRACKING, track.cn0_dbhz
    if not held.any():
        return None
    axes.plot(
        *style.thinned(track.time_s, np.where(held, cn0, np.nan)),
        color=colour,
        linewidth=1.8 if emphasised else 1.0,
        zorder=3 if emphasised else 2,
    )
    return float(np.median(cn0[held][-200:]))


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
