"""Which of the two bands was disturbed: the one whose own carrier left its extrapolation.

Each band's phase before the onset is fitted by a parabola (constant Doppler rate) and
extrapolated past it. The receiver's clock and motion move both bands alike (carrier scaled); an
attack on one band moves that one alone. Where both left, or neither significantly, the answer is
None: it cannot be told from the carriers.

What the receiver's clock did meanwhile moves all satellites alike in time: the median departure of
all other tracks, in s, is taken off first where there are at least three of them, so that a poor
oscillator does not hide which band left.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.phase_difference import phase_sigma_cycles
from sdr_spoof.records import ComboTrack, State, TrackLog
from sdr_spoof.signals import signal_spec

DOMINANCE = 3.0
"""The disturbed band must have left this many times further than the other."""
SIGNIFICANCE = 5.0
"""...and this many standard deviations of its own extrapolation."""
GUARD_S = 0.05
"""Signal just before the estimated onset that is left out of the fit, in s."""


FEWEST_OTHERS = 3
"""Other satellites that it takes to tell the clock: one of them may be attacked too."""
GRID_S = 0.01
"""Step at which their median is taken."""

Clock = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Departure of the receiver's clock at the times given, as an apparent change of range, in s."""


def disturbed_band(
    track: ComboTrack,
    onset_s: float,
    alarm_s: float,
    config: DetectionConfig,
    clock: Clock | None = None,
) -> str | None:
    """Name of the signal that left its extrapolation between onset and alarm, or None."""
    usable = track.state >= State.SYNCED
    time = track.time_s
    before = usable & (time < onset_s - GUARD_S) & (time >= onset_s - config.attribution_fit_s)
    after = usable & (time >= onset_s) & (time <= alarm_s)
    if np.count_nonzero(before) < 20 or np.count_nonzero(after) < 3:
        return None
    late = _late(after)
    moved_s = clock(time[late]) if clock is not None else np.zeros(late.size)
    (upper, upper_sigma), (lower, lower_sigma) = (
        _departure(time, phase, cn0, before, late, moved_s * signal_spec(name).carrier_hz)
        for name, phase, cn0 in (
            (track.upper, track.phase_upper_cycles, track.cn0_upper_dbhz),
            (track.lower, track.phase_lower_cycles, track.cn0_lower_dbhz),
        )
    )
    if upper > max(SIGNIFICANCE * upper_sigma, DOMINANCE * lower):
        return track.upper
    if lower > max(SIGNIFICANCE * lower_sigma, DOMINANCE * upper):
        return track.lower
    return None


def _late(after: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Rows of the last third."""
    rows = np.flatnonzero(after)
    return np.asarray(rows[-max(int(rows.size) // 3, 1) :])


def _departure(
    time_s: NDArray[np.float64],
    phase_cycles: NDArray[np.float64],
    cn0_dbhz: NDArray[np.float64],
    before: NDArray[np.bool_],
    late: NDArray[np.int64],
    explained_cycles: NDArray[np.float64],
) -> tuple[float, float]:
    """Distance of the ``late`` rows from the parabola, and its sigma, in cycles."""
    left, weights = _extrapolated(time_s, phase_cycles, before, late)
    # A departure shows at every row; its mean size must not cancel over a beat, so take rows one
    # by one for the size and the mean weights for the noise.
    size = float(np.sqrt(np.mean((left - explained_cycles) ** 2)))
    epoch_s = float(np.median(np.diff(time_s)))
    cn0_hz = 10.0 ** (float(np.median(cn0_dbhz[before])) / 10.0)
    sigma = float(phase_sigma_cycles(cn0_hz, epoch_s)) * float(
        np.hypot(1.0, np.linalg.norm(weights.mean(axis=0)))
    )
    return size, sigma


def _extrapolated(
    time_s: NDArray[np.float64],
    phase_cycles: NDArray[np.float64],
    before: NDArray[np.bool_],
    late: NDArray[np.int64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distance of each late row from the parabola through ``before``, and the fit's weights."""
    origin = float(time_s[before][-1])
    weights = np.vander(time_s[late] - origin, 3) @ np.linalg.pinv(
        np.vander(time_s[before] - origin, 3)
    )
    reference = phase_cycles[before][-1]
    return phase_cycles[late] - reference - weights @ (phase_cycles[before] - reference), weights


def common_clock(
    log: TrackLog,
    satellite: tuple[str, int],
    onset_s: float,
    alarm_s: float,
    config: DetectionConfig,
) -> Clock | None:
    """Median departure of all other satellites' carriers; None where there are too few."""
    grid = np.arange(onset_s, alarm_s + GRID_S, GRID_S)
    by_satellite: dict[tuple[str, int], list[NDArray[np.float64]]] = {}
    for whole in log.signals:
        spec = signal_spec(whole.signal)
        if (spec.system, whole.prn) == satellite:
            continue
        track = whole.between(onset_s - config.attribution_fit_s, alarm_s)
        held = track.state >= State.TRACKING
        time = track.time_s
        before = held & (time < onset_s - GUARD_S)
        late = np.flatnonzero(held & (time >= onset_s))
        if np.count_nonzero(before) < 20 or late.size < 3 or not held.all():
            continue
        left, _ = _extrapolated(time, track.carrier_phase_cycles, before, late)
        moved = np.interp(grid, time[late], left / spec.carrier_hz)
        by_satellite.setdefault((spec.system, whole.prn), []).append(moved)
    if len(by_satellite) < FEWEST_OTHERS:
        return None
    median = np.median([np.mean(moved, axis=0) for moved in by_satellite.values()], axis=0)
    return lambda time_s: np.interp(time_s, grid, median)
