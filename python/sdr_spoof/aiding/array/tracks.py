"""From the tracks of several antennas to phase differences at common instants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.records import State
from sdr_spoof.signals import satellite_name, signal_spec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.records import SignalTrack, TrackLog

    Floats = NDArray[np.float64]

LONGEST_STEP_S = 0.05
"""Rows further apart are not of one unbroken track."""
_THIRD_DIFFERENCE = 20.0
"""Sum of the squares of 1, 3, 3, 1: variance of a third difference of white noise."""


@dataclass(frozen=True)
class Differences:
    """One signal of a satellite on all antennas."""

    system: str
    prn: int
    signal: str
    cycles: Floats
    """Carrier phase of each antenna less that of the reference, (E, A - 1), NaN where one of them
    is not held."""
    least_slip_cycles: float
    """1 for a pilot; 0.5 where data hide the carrier's sign."""

    @property
    def satellite(self) -> str:
        """RINEX name."""
        return satellite_name(self.system, self.prn)


def differences(logs: Sequence[TrackLog], at_s: Floats) -> list[Differences]:
    """Every signal that is held on all antennas at two instants or more.

    Args:
        logs: one of each antenna, the reference first, of recordings that began with the same
            sample.
        at_s: instants since that sample, ascending, (E,).
    """
    found = []
    for track in logs[0].signals:
        tracks = [track, *(_same(log, track) for log in logs[1:])]
        held = [phase_cycles(t, at_s) for t in tracks if t is not None]
        if len(held) < len(logs):
            continue
        cycles = np.stack([h - held[0] for h in held[1:]], axis=1)
        if np.sum(np.isfinite(cycles).all(axis=1)) >= 2:
            spec = signal_spec(track.signal)
            pilot = _core.periods_per_symbol(track.signal, track.prn) is None
            slip = 1.0 if pilot else 0.5
            found.append(Differences(spec.system, track.prn, track.signal, cycles, slip))
    return found


def phase_cycles(track: SignalTrack, at_s: Floats) -> Floats:
    """Carrier phase at instants (E,), NaN where the signal is not held on both sides of one."""
    time_s, phase = track.time_s, track.carrier_phase_cycles
    good = (track.state >= State.SYNCED) & np.isfinite(phase)
    after = np.clip(np.searchsorted(time_s, at_s), 1, max(len(time_s) - 1, 1))
    if len(time_s) < 2:
        return np.full(at_s.shape, np.nan)
    before = after - 1
    step = time_s[after] - time_s[before]
    share = (at_s - time_s[before]) / step
    usable = good[before] & good[after] & (step < LONGEST_STEP_S) & (share >= 0) & (share <= 1)
    value = phase[before] + share * (phase[after] - phase[before])
    return np.where(usable, value, np.nan)


def noise_cycles(cycles: Floats) -> float:
    """Phase noise of one antenna, from third differences of evenly spaced differences (E, A - 1).

    They leave out turns and motion, which are smooth from one instant to the next. The median
    takes care of slips; NaN with fewer than ten.
    """
    third = np.diff(cycles, n=3, axis=0)
    third = third[np.isfinite(third)]
    if third.size < 10:
        return float("nan")
    spread = float(np.median(np.abs(third))) / 0.6744897501960817
    return spread / float(np.sqrt(2 * _THIRD_DIFFERENCE))


def _same(log: TrackLog, track: SignalTrack) -> SignalTrack | None:
    mine = (track.signal, track.prn)
    return next((t for t in log.signals if (t.signal, t.prn) == mine), None)
