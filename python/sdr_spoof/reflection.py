"""Whether a reflection explains what was seen of a satellite.

An echo is weaker than the direct signal, by a ratio below 1, and comes in every band, some time
later. What follows from that, whatever its phase and however it moves:

* it bends the correlation peaks of *all* bands, at once: by shape, or by a bias of the code against
  its carrier. A spoofer in one band leaves the other's peak alone;
* the sum's phase stays within asin(ratio), a quarter of a cycle, of the direct signal's, and the
  scaled difference of two carriers within half a cycle: it swings, but does not turn. A captured
  carrier leaves for ever;
* the code is biased by no more than half the early-late distance, the envelope of a correlator
  (M. Braasch, "Multipath effects", in *Global Positioning System: Theory and Applications*, vol. 1,
  1996, chapter 14). A captured code leaves for ever;
* power rises by 6 dB at most, for an echo as strong as the satellite, by 3 dB on average over its
  phases, and falls as often. A spoofer that takes the loops over is the stronger signal. What the
  test of power calls a rise, 3 dB and more, is taken for a spoofer's.

A spoofer that keeps to all of that in both bands at once passes for an echo, until it leaves the
bounds.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.attribution import SHARED_LOOP, kind_of
from sdr_spoof.detectors import (
    DetectionConfig,
    code_difference,
    code_minus_carrier,
    phase_difference_rate,
    second_peak,
)
from sdr_spoof.detectors.phase_difference import epoch_of, scaled_difference, settled
from sdr_spoof.detectors.presence import present
from sdr_spoof.detectors.slips import repair_every_slip
from sdr_spoof.detectors.windows import sliding_mean
from sdr_spoof.records import Alarm, SignalTrack, State, TrackLog
from sdr_spoof.satellites import combos_of, tracks_of
from sdr_spoof.signals import LIGHT_M_S

TOGETHER_S = 2.0
"""What one reflection does to both bands is dated no further apart."""
PHASE_REACH_CYCLES = 0.5
"""Two carriers, each a quarter of a cycle off."""
PHASE_MEAN_S, CODE_MEAN_S = 0.1, 1.0
"""Means of the phase difference and of the codes that must stay within reach."""
BEFORE_S, AFTER_S = 5.0, 300.0
"""Signal before the event that their level is taken from, and how long they are followed."""
GUARD_S = 0.5
"""Left out between: an onset may be dated late."""


def explains(
    log: TrackLog,
    satellite: tuple[str, int],
    alarms: Sequence[Alarm],
    deciding: Sequence[Alarm],
    config: DetectionConfig,
) -> bool:
    """Whether an echo that came, went or moved can have raised all these alarms."""
    kinds = {kind_of(a) for a in alarms}
    beyond = (phase_difference_rate.NAME, second_peak.NAME)
    if "power" in kinds or any(a.detector in beyond for a in deciding):
        return False
    first_s = min(deciding, key=lambda a: a.alarm_s).onset_s
    bent_s = bent(log, satellite, alarms)
    if not bent_s or max(bent_s) - min(bent_s) > TOGETHER_S or max(bent_s) > first_s + TOGETHER_S:
        return False
    onset_s = min(first_s, *bent_s)
    return phase_reach(log, satellite, onset_s, config) < PHASE_REACH_CYCLES and all(
        code_reach_m(track, onset_s, config) < LIGHT_M_S * half_spacing_s(track)
        for track in tracks_of(log, *satellite)
    )


def bent(log: TrackLog, satellite: tuple[str, int], alarms: Sequence[Alarm]) -> list[float]:
    """When each band's peak was first seen to be bent; empty if one was not, or there is but one.

    One code loop steers both bands: that a peak has lost its symmetry says nothing of its own.
    """
    held = {t.signal for t in tracks_of(log, *satellite)}
    for combo in combos_of(log, *satellite):
        held |= {combo.lower, combo.upper}
    found: dict[str, Alarm] = {}
    for alarm in sorted(alarms, key=lambda a: a.alarm_s):
        own = alarm.detector not in (SHARED_LOOP, code_difference.NAME)
        if alarm.band in held and own and kind_of(alarm) in ("shape", "code"):
            # Tests with long windows alarm later, and date worse.
            found.setdefault(alarm.band, alarm)
    onsets_s = sorted(a.onset_s for a in found.values())
    return onsets_s if len(held) > 1 and found.keys() == held else []


def phase_reach(
    log: TrackLog, satellite: tuple[str, int], onset_s: float, config: DetectionConfig
) -> float:
    """How far the scaled phase difference has gone since the onset, in cycles."""
    reach = 0.0
    for whole in combos_of(log, *satellite):
        track = whole.between(onset_s - BEFORE_S, onset_s + AFTER_S)
        there = present(log, track, config.min_cn0_dbhz)
        difference = scaled_difference(track, config.settle_s, repair_every_slip, there)
        rows = round(PHASE_MEAN_S / difference.epoch_s)
        for piece in difference.pieces:
            times, values = track.time_s[piece], difference.cycles[piece]
            reach = max(reach, _departure(times, values, onset_s, rows))
    return reach


def code_reach_m(track: SignalTrack, onset_s: float, config: DetectionConfig) -> float:
    """How far the code has left its carrier since the onset, in m."""
    near = track.between(onset_s - BEFORE_S, onset_s + AFTER_S)
    usable = (near.state >= State.SYNCED) & (near.cn0_dbhz >= config.min_cn0_dbhz)
    epoch_s = epoch_of(near)
    pieces = settled(near.time_s, usable, round(config.settle_s / epoch_s))
    metres = code_minus_carrier.difference_m(near, pieces)
    rows = round(CODE_MEAN_S / epoch_s)
    reaches = (_departure(near.time_s[p], metres[p], onset_s, rows) for p in pieces)
    return max(reaches, default=0.0)


def half_spacing_s(track: SignalTrack) -> float:
    """Half the distance between early and late tap."""
    return float(track.tap_offsets_s[track.prompt_tap + 1] - track.tap_offsets_s[track.prompt_tap])


def _departure(
    time_s: NDArray[np.float64], values: NDArray[np.float64], onset_s: float, rows: int
) -> float:
    """Largest distance of a mean over so many rows from the level before the onset; 0 for none."""
    before = time_s < onset_s - GUARD_S
    after = values[time_s >= onset_s]
    if np.count_nonzero(before) < rows or after.size < rows:
        return 0.0
    return float(np.max(np.abs(sliding_mean(after - np.mean(values[before]), rows))))
