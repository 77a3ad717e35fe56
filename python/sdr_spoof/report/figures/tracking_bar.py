"""How each signal of a satellite was tracked over time, and what to do with it after the alarm."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from sdr_spoof.fusion import SPOOFED
from sdr_spoof.records import SignalTrack, State
from sdr_spoof.report.figures import style
from sdr_spoof.report.figures.case import Case
from sdr_spoof.signals import signal_spec

JOINT, ALONE, ISOLATED = 3, 2, 4
"""What a stretch of a bar says: joint loops, own loops, marked as captured."""
SHADES = {JOINT: 0.9, ALONE: 0.45, ISOLATED: 0.9}
NAMES = {JOINT: "both bands jointly", ALONE: "by itself", ISOLATED: "isolated as captured"}
LEAST_PART = 0.14
"""Shortest stretch that is named, of the whole recording."""


def draw(axes: Axes, case: Case) -> None:
    """A bar per signal, and in it what became of the band, or what the verdict says of it."""
    for row, track in enumerate(case.tracks):
        for kind, start_s, stop_s in stretches(track):
            colour = style.ALARM if kind == ISOLATED else style.colour(track.signal)
            _bar(axes, row, (start_s, stop_s), colour, SHADES[kind])
            named_until_s = min(stop_s, case.onset_s)
            if named_until_s - start_s > LEAST_PART * case.log.duration_s:
                _text(axes, row, start_s, NAMES[kind], on_pale=kind == ALONE)
        if case.satellite.verdict == SPOOFED:
            _fallback(axes, case, track, row)
    axes.set_yticks(range(len(case.tracks)), [signal_spec(t.signal).composite for t in case.tracks])
    axes.set_ylim(-0.6, len(case.tracks) - 0.4)
    axes.grid(visible=False)
    axes.set_ylabel("Tracked")


def _bar(axes: Axes, row: int, part_s: tuple[float, float], colour: str, alpha: float) -> None:
    start_s, stop_s = part_s
    axes.barh(row, stop_s - start_s, 0.72, start_s, color=colour, alpha=alpha, linewidth=0)


def _text(axes: Axes, row: int, at_s: float, text: str, *, on_pale: bool) -> None:
    axes.text(
        at_s,
        row,
        f" {text}",
        va="center",
        fontsize=8,
        fontweight="bold",
        color=style.INK if on_pale else "white",
        zorder=6,
    )


def _fallback(axes: Axes, case: Case, track: SignalTrack, row: int) -> None:
    """Where tracking isolated a band, that; otherwise the verdict's advice from the alarm on."""
    satellite = case.satellite
    isolated = {t.signal: isolated_s(t) for t in case.tracks}
    from_s = min((s for s in isolated.values() if s is not None), default=None)
    if from_s is not None:
        mine_s = isolated[track.signal]
        text = f"isolated as captured at {mine_s:.2f} s" if mine_s else "fallback: goes on alone"
        _text(axes, row, mine_s or from_s, text, on_pale=mine_s is None)
    elif track.signal == satellite.band:
        _bar(axes, row, (case.alarm_s, case.log.duration_s), style.ALARM, 1.0)
        _text(axes, row, case.alarm_s, "verdict: captured, do not use it", on_pale=False)
    elif track.signal == satellite.fallback:
        parted_s = fell_back(track, case.onset_s)
        parted = f" (parted at {parted_s:.2f} s)" if parted_s is not None else ""
        text = f"verdict: fall back to this band alone{parted}"
        _text(axes, row, case.alarm_s, text, on_pale=parted_s is not None)


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
