"""Pseudorange from the subcarrier of a satellite's B1I and B1C: the phase of their beat.

The beat turns once in 20.93 m. Where the sign of B1I is known from its message, the mean of both
codes chooses between steps of that; where it is not, half a cycle of B1I's phase is open, and the
steps are 10.47 m (docs/conventions.md, subcarrier range). Group delays that the satellite states
are taken out of the codes before the choice. The result is that of a :class:`Run` whose code time
is the beat's, on the counter of the upper signal, and whose phase is that signal's.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import scipy

from sdr_spoof.records import ComboTrack, State
from sdr_spoof.signals import signal_spec

from .runs import LEAST_ROWS, Run

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from .polarity import Polarity
    from .transmit import Span

CHOSEN_FROM_S = 60.0
"""So much of a stretch, at most, chooses the step."""
SIGMAS = 4.0
"""The mean difference of code and beat must have so many standard deviations to half a step."""
CHECKED_S = 4.0
ASTRAY = 0.75
"""Where the difference's mean over this time leaves the step by so much of one, a slip went
unseen: no range there."""


def subcarrier_spans(
    combo: ComboTrack,
    upper: Sequence[Span],
    lower: Sequence[tuple[Run, Polarity]],
    group_delays_s: tuple[float, float],
) -> Iterator[tuple[Span, bool]]:
    """Spans of the beat, and whether the steps are half ones (B1I's sign unknown).

    ``group_delays_s`` are those of the lower and the upper signal.
    """
    time_s = combo.time_s
    for span in upper:
        for run, sign in lower:
            first = max(span.from_s, float(run.time_s[0]))
            last = min(span.until_s, float(run.time_s[-1]))
            a, b = np.searchsorted(time_s, first), np.searchsorted(time_s, last, side="right")
            for rows in _unbroken(combo.part(int(a), int(b)), (run, span.run), sign):
                half = bool(sign.unknown(rows.time_s).any())
                beat = _resolved(rows, span.run, sign, half, group_delays_s)
                if beat is not None:
                    start, stop = float(beat.time_s[0]), float(beat.time_s[-1])
                    yield replace(span, run=beat, from_s=start, until_s=stop), half


def _unbroken(rows: ComboTrack, runs: tuple[Run, Run], sign: Polarity) -> Iterator[ComboTrack]:
    """Stretches in which neither phase may have slipped."""
    if rows.epochs < LEAST_ROWS:
        return
    broken = np.diff(rows.time_s, prepend=rows.time_s[0]) > 1.5 * np.median(rows.integration_s)
    for run in runs:
        last = np.searchsorted(run.time_s, rows.time_s + 0.25 * run.integration_s) - 1
        broken |= run.slipped[np.clip(last, 0, run.time_s.size - 1)]
    broken[1:] |= np.diff(sign.turned(rows.time_s)) | np.diff(sign.unknown(rows.time_s))
    edges = [0, *np.flatnonzero(broken), rows.epochs]
    for a, b in pairwise(edges):
        if b - a >= LEAST_ROWS:
            yield rows.part(int(a), int(b))


def _resolved(
    rows: ComboTrack, upper: Run, sign: Polarity, half: bool, group_delays_s: tuple[float, float]
) -> Run | None:
    """The beat's run, its step chosen; None where the codes are too noisy to choose."""
    spacing_hz = upper.spec.carrier_hz - signal_spec(rows.lower).carrier_hz
    if spacing_hz == 0.0 or (rows.state < State.SYNCED).any():
        return None
    lower_cycles = rows.phase_lower_cycles + 0.5 * sign.turned(rows.time_s)
    beat_s = (rows.phase_upper_cycles - lower_cycles) / spacing_hz
    step_s = (0.5 if half else 1.0) / spacing_hz
    code_s, sigma_s = _mean_code(rows, beat_s, group_delays_s)
    count = min(max(round(CHOSEN_FROM_S / upper.integration_s), 1), rows.epochs)
    if SIGMAS * sigma_s / np.sqrt(count) > 0.5 * step_s:
        return None
    difference_s = code_s - beat_s
    beat_s = beat_s + step_s * round(float(np.mean(difference_s[:count])) / step_s)
    size = max(1, round(CHECKED_S / upper.integration_s))
    astray = np.abs(scipy.ndimage.uniform_filter1d(code_s - beat_s, size, mode="nearest"))
    cn0 = -10.0 * np.log10(
        10.0 ** (-0.1 * rows.cn0_lower_dbhz) + 10.0 ** (-0.1 * rows.cn0_upper_dbhz)
    )
    nothing = np.zeros(rows.epochs, np.bool_)
    return Run(
        spec=upper.spec,
        time_s=rows.time_s,
        code_s=-beat_s,
        code_error_s=np.zeros(rows.epochs),
        phase_cycles=rows.phase_upper_cycles,
        cn0_dbhz=cn0,
        slipped=nothing,
        settled=astray <= ASTRAY * step_s,
        unsettled_s=np.zeros(rows.epochs),
        captured=rows.state == State.CAPTURED,
        integration_s=upper.integration_s,
    )


def _mean_code(
    rows: ComboTrack, beat_s: NDArray[np.float64], group_delays_s: tuple[float, float]
) -> tuple[NDArray[np.float64], float]:
    """Delay by both codes, weighted by their noise, in periods of the upper one; its sigma."""
    upper_s = rows.code_delay_upper_s - group_delays_s[1]
    lower_s = rows.code_delay_upper_s - rows.code_difference_s - group_delays_s[0]
    noise = [float(np.var(code_s - beat_s)) + 1e-24 for code_s in (lower_s, upper_s)]
    weights = [noise[1] / sum(noise), noise[0] / sum(noise)]
    sigma_s = float(np.sqrt(noise[0] * noise[1] / sum(noise)))
    return weights[0] * lower_s + weights[1] * upper_s, sigma_s
