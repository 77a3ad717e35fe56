"""How each signal of a satellite was tracked over time, and what to do with it after the alarm."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.fusion import SPOOFED
from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.chart import Axis, Panel
from sdr_spoof.report.chart.marks import Note
from sdr_spoof.report.figures import style
from sdr_spoof.report.figures.case import Case
from sdr_spoof.signals import signal_spec

JOINT, ALONE, ISOLATED = 3, 2, 4
"""What a stretch of a bar says: joint loops, own loops, marked as captured."""
SHADES = {JOINT: 0.9, ALONE: 0.45, ISOLATED: 0.9}
NAMES = {JOINT: "both bands jointly", ALONE: "by itself", ISOLATED: "isolated as captured"}
LEAST_PART = 0.14
"""Shortest stretch that is named, of the whole recording."""


def panel(case: Case) -> Panel:
    """A bar per signal, and in it what became of the band, or what the verdict says of it."""
    rows = range(len(case.tracks))
    bands = [signal_spec(t.signal).composite for t in case.tracks]
    made = Panel(
        x=Axis(grid=False),
        y=Axis("Tracked", -0.6, len(rows) - 0.4, ticks=rows, names=bands, grid=False),
    )
    for row, track in enumerate(case.tracks):
        for kind, start_s, stop_s in stretches(track):
            colour = style.ALARM if kind == ISOLATED else style.colour(track.signal)
            _bar(made, row, (start_s, stop_s), colour, SHADES[kind])
            named_until_s = min(stop_s, case.onset_s)
            if named_until_s - start_s > LEAST_PART * case.log.duration_s:
                _text(made, row, start_s, NAMES[kind], on_pale=kind == ALONE)
        if case.satellite.verdict == SPOOFED:
            _fallback(made, case, track, row)
    return made


def _bar(panel: Panel, row: int, part_s: tuple[float, float], colour: str, opacity: float) -> None:
    panel.bar(part_s, (row - 0.36, row + 0.36), colour, opacity)


def _text(panel: Panel, row: int, at_s: float, text: str, *, on_pale: bool) -> None:
    colour = style.INK if on_pale else "white"
    panel.note(Note(at_s, row, text, colour, bold=True, shift=(4.0, 4.0)))


def _fallback(panel: Panel, case: Case, track: SignalTrack, row: int) -> None:
    """Where tracking isolated a band, that; otherwise the verdict's advice from the alarm on."""
    satellite = case.satellite
    isolated = {t.signal: isolated_s(t) for t in case.tracks}
    from_s = min((s for s in isolated.values() if s is not None), default=None)
    if from_s is not None:
        mine_s = isolated[track.signal]
        text = f"isolated as captured at {mine_s:.2f} s" if mine_s else "fallback: goes on alone"
        _text(panel, row, mine_s or from_s, text, on_pale=mine_s is None)
    elif track.signal == satellite.band:
        _bar(panel, row, (case.alarm_s, case.log.duration_s), style.ALARM, 1.0)
        _text(panel, row, case.alarm_s, "verdict: captured, do not use it", on_pale=False)
    elif track.signal == satellite.fallback:
        parted_s = fell_back(track, case.onset_s)
        parted = f" (parted at {parted_s:.2f} s)" if parted_s is not None else ""
        text = f"verdict: fall back to this band alone{parted}"
        _text(panel, row, case.alarm_s, text, on_pale=parted_s is not None)


def isolated_s(track: SignalTrack) -> float | None:
    """When the track was first marked as captured."""
    marked = np.flatnonzero(track.state == State.CAPTURED)
    return float(track.time_s[marked[0]]) if marked.size else None


def fell_back(track: SignalTrack, onset_s: float) -> float | None:
    """When, from the onset on, the track first left the joint loops; None if it never did."""
    joint = track.state == State.COMBO
    left = np.flatnonzero(joint[:-1] & ~joint[1:]) + 1
    left = left[track.time_s[left] >= onset_s]
    return float(track.time_s[left[0]]) if left.size else None


def stretches(track: SignalTrack) -> list[tuple[int, float, float]]:
    """(kind, start, end) of the stretches in which a signal was held in one way."""
    kinds = _kinds(track.state)
    if not kinds.size:
        return []
    edges = [0, *(np.flatnonzero(np.diff(kinds)) + 1).tolist(), kinds.size]
    times = np.append(track.time_s, track.time_s[-1])
    return [
        (int(kinds[a]), float(times[a]), float(times[b])) for a, b in pairwise(edges) if kinds[a]
    ]


def _kinds(state: NDArray[np.uint8]) -> NDArray[np.int64]:
    kinds = np.where(state >= State.TRACKING, ALONE, 0)
    kinds[state == State.COMBO] = JOINT
    kinds[state == State.CAPTURED] = ISOLATED
    return np.asarray(kinds)
