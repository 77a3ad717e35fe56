"""Acquisition overview and C/N0 over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sdr_spoof.records import Acquisition, SignalTrack, State, TrackLog
from sdr_spoof.report.chart import Axis, Drawing, Entry, Grid, Panel, drawing
from sdr_spoof.report.chart.marks import Note
from sdr_spoof.report.chart.scale import stretch
from sdr_spoof.report.figures import style
from sdr_spoof.report.figures.satellite import SAMPLED_EPOCHS
from sdr_spoof.report.words import satellite_name
from sdr_spoof.signals import system_of


def draw_acquisition(acquisitions: Sequence[Acquisition]) -> Drawing:
    """Bars of C/N0 and marks of Doppler per satellite and signal; detected ones only."""
    found = [a for a in acquisitions if a.detected]
    satellites = sorted({(system_of(a.signal), a.prn) for a in found})
    signals = list(dict.fromkeys(a.signal for a in found))
    strength, doppler = _bar_panels(satellites)
    lowest = min((a.cn0_dbhz for a in found), default=30.0)
    strength.y.low = min(30.0, lowest - 3.0)
    width = 0.8 / max(len(signals), 1)
    for number, signal in enumerate(signals):
        colour = style.colour(signal)
        for a in (a for a in found if a.signal == signal):
            at = satellites.index((system_of(signal), a.prn))
            at_x = at + (number - (len(signals) - 1) / 2) * width
            half = 0.46 * width
            strength.bar((at_x - half, at_x + half), (strength.y.low, a.cn0_dbhz), colour)
            stem = np.array([0.0, a.doppler_hz])
            doppler.line(np.full(2, at_x), stem, colour, 2.0)
            doppler.dots([at_x], [a.doppler_hz], colour, 7.0)
    legend = [Entry(signal, style.colour(signal)) for signal in signals]
    return drawing(Grid([[strength, doppler]], [190.0]), legend=legend)


def _bar_panels(satellites: Sequence[tuple[str, int]]) -> tuple[Panel, Panel]:
    def axis() -> Axis:
        names = [satellite_name(*s) for s in satellites]
        ends = -0.6, max(len(satellites), 1) - 0.4
        places = range(len(satellites))
        return Axis("", *ends, ticks=places, names=names, grid=False, turned=len(satellites) > 12)

    strength = Panel("Signal strength at acquisition", axis(), Axis("C/N0 (dB-Hz)"))
    doppler = Panel("Doppler at acquisition", axis(), Axis("Doppler (Hz)"))
    doppler.level(0.0, style.MUTED, 1.0)
    return strength, doppler


def draw_cn0(log: TrackLog, verdicts: Mapping[tuple[str, int], str]) -> Drawing:
    """C/N0 over time, one panel per signal; red: spoofed, amber: suspect, grey: all others."""
    panels = []
    for signal in dict.fromkeys(t.signal for t in log.signals):
        panel = Panel(signal, Axis("Time (s)", 0.0, log.duration_s * 1.06))
        ends = []
        for track in (t for t in log.signals if t.signal == signal):
            colour = style.VERDICTS.get(verdicts.get((system_of(signal), track.prn), ""))
            end = _cn0_line(panel, track, colour or "#a9b2bb", colour is not None)
            if end is not None:
                ends.append((end, _name(track), colour or style.MUTED))
        panels.append((panel, ends))
    low, high = _limits([panel for panel, _ in panels])
    for panel, ends in panels:
        panel.y.low, panel.y.high = low, high
        _name_lines(panel, ends, log.duration_s)
    panels[0][0].y.label = "C/N0 (dB-Hz)"
    return drawing(Grid([[panel for panel, _ in panels]], [230.0], share_y=True))


def _name(track: SignalTrack) -> str:
    return satellite_name(system_of(track.signal), track.prn)


def _limits(panels: Sequence[Panel]) -> tuple[float, float]:
    reaches = [panel.reach(1) for panel in panels]
    return stretch(min(low for low, _ in reaches), max(high for _, high in reaches), 0.05)


def _cn0_line(panel: Panel, track: SignalTrack, colour: str, emphasised: bool) -> float | None:
    """Draws a track; returns the C/N0 at which it ends, None if it was never held."""
    track = track.sampled(SAMPLED_EPOCHS)
    held, cn0 = track.state >= State.TRACKING, track.cn0_dbhz
    if not held.any():
        return None
    values = np.where(held, cn0, np.nan)
    panel.line(track.time_s, values, colour, 2.4 if emphasised else 1.3)
    return float(np.median(cn0[held][-200:]))


def _name_lines(panel: Panel, ends: list[tuple[float, str, str]], time_s: float) -> None:
    """Writes names at the right end of the lines, moved apart so that none overlap."""
    low, high = panel.y.low or 0.0, panel.y.high or 1.0
    ends = sorted(ends)
    spacing = min(0.055, 1.0 / max(len(ends), 1)) * (high - low)
    places = [cn0 for cn0, _, _ in ends]
    for i in range(1, len(places)):
        places[i] = max(places[i], places[i - 1] + spacing)
    room = high
    for i in reversed(range(len(places))):  # push back down what stands out at the top
        places[i] = min(places[i], room)
        room = places[i] - spacing
    size = 11.0 if len(ends) <= 18 else 9.0
    for at, (_, name, colour) in zip(places, ends, strict=True):
        panel.note(Note(time_s, at, name, colour, size, shift=(4.0, 4.0)))
