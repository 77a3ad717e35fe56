"""Stretches of a track without a break, in memory and ready to be interpolated."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import scipy

from sdr_spoof.gaps import counted
from sdr_spoof.records import SignalTrack, State
from sdr_spoof.signals import SignalSpec, signal_spec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.gaps import Span

LEAST_ROWS = 5
"""Shorter runs are not looked at."""
GAP_EPOCHS = 1.5
"""Rows farther apart than this, in integrations, do not belong to one run."""
JUMP_CHIPS = 0.1
"""A code replica that moves by more than this between two rows, beyond what the Doppler tells,
was moved by hand: off a side peak."""
UNSETTLED_SIGMAS = 6.0
SETTLED_S = 0.1
"""The discriminator's mean over this time must lie within so many standard deviations of zero.
The code loop of 1 Hz needs 0.25 s: where samples are missing, or before it has settled, the mean
stands out, and the replica is not where the signal is."""
SEARCHED_CHIPS, LOOP_S = 0.08, 0.25
"""Where a code loop begins, rms, after a search that may miss by a quarter of a chip and what
pull-in makes good of it; and its time constant, 1 Hz being its noise bandwidth."""
ASTRAY_SIGMAS = 4.0
"""A mean of the discriminator over the loop's time constant that is larger says how far it is off.
"""
LEAVING_S = 0.5
"""A loss of lock is declared 0.24 to 0.51 s after the signal has gone; until then the loops follow
noise."""
CN0_MEMORY_S, FADED = 0.5, 0.1
"""The tracker's running mean of C/N0 (``track/sideband.rs``); prompts with less than such a part of
its power are beside the signal: at the foot of its peak both loops may hold on for a second."""
HELD_S = 1.0
"""By then that mean is one over its whole memory."""
SLIP_SIGMAS = 6.0
SLIP_CYCLES = (0.1, 0.2)
"""A phase error beyond six standard deviations, but no less than the first and no more than the
second, may be a slip."""


@dataclass(frozen=True)
class Run:
    """N rows of one signal between which neither code nor carrier was lost."""

    spec: SignalSpec
    time_s: NDArray[np.float64]
    code_s: NDArray[np.float64]
    """Received code time (phase over chip rate) minus ``time_s``: falls as the range grows."""
    code_error_s: NDArray[np.float64]
    """What the discriminator adds to the oscillator in ``code_s``."""
    phase_cycles: NDArray[np.float64]
    cn0_dbhz: NDArray[np.float64]
    slipped: NDArray[np.bool_]
    """Whether the phase may have slipped since the row before."""
    settled: NDArray[np.bool_]
    """Whether the code replica is on the signal."""
    unsettled_s: NDArray[np.float64]
    """Standard deviation of what ``code_s`` may be off, beyond the noise of a settled loop."""
    captured: NDArray[np.bool_]
    integration_s: float

    def rows(self, chosen: slice | NDArray[np.intp]) -> Run:
        """Some of the rows."""
        arrays = [f.name for f in fields(self) if isinstance(getattr(self, f.name), np.ndarray)]
        return replace(self, **{name: getattr(self, name)[chosen] for name in arrays})

    def outline(self) -> Run:
        """A row a second, and the last one: enough to tell code periods apart."""
        step = max(1, round(1.0 / self.integration_s))
        last = self.time_s.size - 1
        return self.rows(np.unique(np.append(np.arange(0, last, step), last)))


def runs_of(
    track: SignalTrack, uncounted: Sequence[Span] = (), *, measured: bool = False
) -> list[Run]:
    """Unbroken runs of a track in ``SYNCED`` or better, without spans where the count ended.

    With ``measured``, ``code_s`` is that of oscillator plus discriminator.
    """
    whole = _rows(track, uncounted)
    if whole is None:
        return []
    edges = [0, *(np.flatnonzero(_breaks(whole)) + 1).tolist(), whole.time_s.size]
    runs = (whole.rows(slice(a, b)) for a, b in pairwise(edges))
    found = [_judged(run) for run in runs if run.time_s.size >= LEAST_ROWS]
    if measured:
        found = [replace(r, code_s=r.code_s + r.code_error_s) for r in found]
    return found


def _rows(track: SignalTrack, uncounted: Sequence[Span]) -> Run | None:
    """All rows that count as one run; None without any."""
    spec = signal_spec(track.signal)
    state = track.state
    outside, _ = counted(track.time_s, 0.5 * track.integration_s, uncounted)
    kept = np.flatnonzero((state >= State.SYNCED) & outside)
    if not kept.size:
        return None
    time_s = track.time_s[kept]
    error_s = track.code_error_chips[kept] / spec.chip_rate_hz
    phase_cycles = track.carrier_phase_cycles[kept]
    held_s, left_s = (side_s[kept] for side_s in _lock(track))
    cn0_dbhz = track.cn0_dbhz[kept]
    faded = _faded(cn0_dbhz, track.integration_s[kept]) & (held_s > HELD_S)
    return Run(
        spec=spec,
        time_s=time_s,
        code_s=track.code_phase_chips[kept] / spec.chip_rate_hz - error_s - time_s,
        code_error_s=error_s,
        phase_cycles=phase_cycles,
        cn0_dbhz=cn0_dbhz,
        slipped=_slips(track.phase_error_cycles[kept], phase_cycles, _sigma_cycles(track, kept)),
        settled=(left_s > LEAVING_S) & ~faded,
        unsettled_s=SEARCHED_CHIPS / spec.chip_rate_hz * np.exp(-held_s / LOOP_S),
        captured=state[kept] == State.CAPTURED,
        integration_s=float(np.median(track.integration_s[kept])),
    )


def _lock(track: SignalTrack) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """For how long each row's lock has lasted, and for how long it will; infinite at the end."""
    lost = np.flatnonzero(track.state == State.LOST)
    before = np.searchsorted(lost, np.arange(track.epochs))
    begin = np.concatenate([[0], np.minimum(lost + 1, track.epochs - 1)])
    end_s = np.append(track.time_s[lost], np.inf)
    return track.time_s - track.time_s[begin][before], end_s[before] - track.time_s


def _faded(cn0_dbhz: NDArray[np.float64], integration_s: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Rows whose own power, which the running mean of C/N0 tells, is a small part of it."""
    mean = 10.0 ** (0.1 * cn0_dbhz)
    own = mean + np.diff(mean, prepend=mean[:1]) * CN0_MEMORY_S / integration_s
    count = max(1, round(SETTLED_S / float(np.median(integration_s))))
    return np.asarray(scipy.ndimage.uniform_filter1d(own, count, mode="nearest") < FADED * mean)


def _slips(
    error_cycles: NDArray[np.float64],
    phase_cycles: NDArray[np.float64],
    sigma_cycles: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Rows whose phase error is more than noise: the loop may come to rest on another cycle.

    Not where the measured phase goes on smoothly, with noise low enough to tell: the loop then
    only lags behind a motion, and the discriminator still says by how much.
    """
    suspicious = np.abs(error_cycles) > np.clip(SLIP_SIGMAS * sigma_cycles, *SLIP_CYCLES)
    bend_sigmas = SLIP_SIGMAS * np.sqrt(6.0) * sigma_cycles
    bend = np.abs(np.diff(phase_cycles, 2))
    largest = np.zeros(error_cycles.size)
    for shift in range(3):
        part = slice(shift, shift + bend.size)
        largest[part] = np.maximum(largest[part], bend)
    least, most = SLIP_CYCLES
    smooth = (bend_sigmas <= most) & (largest <= np.maximum(bend_sigmas, least))
    return np.asarray(suspicious & ~smooth)


def _sigma_cycles(track: SignalTrack, kept: NDArray[np.intp]) -> NDArray[np.float64]:
    """Thermal noise of one row's phase."""
    snr = 2.0 * 10.0 ** (0.1 * track.cn0_dbhz[kept]) * track.integration_s[kept]
    return np.asarray(1.0 / (2.0 * np.pi * np.sqrt(np.maximum(snr, 1e-3))))


def _breaks(run: Run) -> NDArray[np.bool_]:
    """Whether each row but the last is the last of a run."""
    steps_s = np.diff(run.time_s)
    predicted = -np.diff(run.phase_cycles) / run.spec.carrier_hz
    moved_s = np.diff(run.code_s) - predicted
    jump_s = JUMP_CHIPS / run.spec.chip_rate_hz
    return (steps_s > GAP_EPOCHS * run.integration_s) | (np.abs(moved_s) > jump_s)


def _judged(run: Run) -> Run:
    """Say where else the code loop has not settled, and by how much it is off."""
    mean_s, sigma_s = _discriminator(run, SETTLED_S)
    settled = run.settled & (np.abs(mean_s) <= UNSETTLED_SIGMAS * sigma_s)
    mean_s, sigma_s = _discriminator(run, LOOP_S)
    astray_s = np.where(np.abs(mean_s) > ASTRAY_SIGMAS * sigma_s, mean_s, 0.0)
    return replace(run, settled=settled, unsettled_s=np.hypot(run.unsettled_s, astray_s))


def _discriminator(run: Run, window_s: float) -> tuple[NDArray[np.float64], float]:
    """Mean of the discriminator over a window, and its standard deviation in a settled loop."""
    count = max(1, round(window_s / run.integration_s))
    mean_s = scipy.ndimage.uniform_filter1d(run.code_error_s, count, mode="nearest")
    # Steps from row to row, and their quartiles, do not see a transient.
    steps_s = np.diff(run.code_error_s)
    spread_s = float(np.subtract(*np.percentile(steps_s, [75, 25]))) / 1.349 / np.sqrt(2.0)
    return mean_s, spread_s / np.sqrt(min(count, run.time_s.size))
