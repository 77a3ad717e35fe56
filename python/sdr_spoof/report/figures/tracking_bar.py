"""How each signal of a satellite was tracked over time, and what to do with it after the alarm."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

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
    """A bar per signal; from the alarm on a line under it: captured, or use it alone."""
    duration_s = case.log.duration_s
    for row, track in enumerate(case.tracks):
        for kind, start_s, stop_s in stretches(track):
            colour = style.ALARM if kind == ISOLATED else style.colour(track.signal)
            axes.barh(
                row, stop_s - start_s, 0.72, start_s, color=colour, alpha=SHADES[kind], linewidth=0
            )
            named_until_s = min(stop_s, case.onset_s)
            if named_until_s - start_s > LEAST_PART * duration_s:
                axes.text(start_s, row, f" {NAMES[kind]}", **_INSIDE)
        _advice(axes, case, track, row)
    axes.set_yticks(range(len(case.tracks)), [signal_spec(t.signal).composite for t in case.tracks])
    axes.set_ylim(-0.6, len(case.tracks) - 0.4)
    axes.grid(visible=False)
    axes.set_ylabel("Tracked")


_INSIDE: dict[str, Any] = {
    "va": "center",
    "ha": "left",
    "fontsize": 8,
    "color": "white",
    "fontweight": "bold",
}


def _advice(axes: Axes, case: Case, track: SignalTrack, row: int) -> None:
    """What the verdict says of this signal from the alarm on."""
    satellite = case.satellite
    text = ""
    if track.signal == satellite.band:
        text = "verdict: captured, do not use it"
    elif track.signal == satellite.fallback:
        text = "verdict: fall back to this band alone"
    if not text or satellite.verdict != "spoofed":
        return
    width_s = case.log.duration_s - case.alarm_s
    if track.signal == satellite.band:
        axes.barh(row, width_s, 0.72, case.alarm_s, color=style.ALARM, linewidth=0, zorder=3)
    parted_s = fell_back(track, case.alarm_s)
    if parted_s is not None:
        axes.plot(parted_s, row, "|", color="white", markersize=14, markeredgewidth=2, zorder=5)
        text += f" (loops parted at {parted_s:.2f} s)"
    axes.text(case.alarm_s, row, f" {text}", zorder=6, **_INSIDE)


def fell_back(track: SignalTrack, alarm_s: float) -> float | None:
    """When, from the alarm on, the track first left the joint loops; None if it never did."""
    joint = track.state == State.COMBO
    left = np.flatnonzero(joint[:-1] & ~joint[1:]) + 1
    left = left[track.time_s[left] >= alarm_s]
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
