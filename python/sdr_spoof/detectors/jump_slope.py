"""Generalised likelihood ratio of a jump and a slope over sliding windows of several lengths.

Rows y are equally spaced. H0: a constant level with white noise. H1: over the last n rows the
level has jumped and turns, by any amounts. With the level taken from up to m rows before the
window, twice the log-likelihood ratio is the energy T = u_jump^2 + u_slope^2 of

    u_jump  = (mean of the window - mean of the reference) / (sigma sqrt(1 / n + 1 / m))
    u_slope = least-squares slope of the window / (sigma sqrt(12 / (n (n^2 - 1))) / step)

(Kay, *Fundamentals of Statistical Signal Processing: Detection Theory*, 1998, section 7.8 for the
linear model, 9.4 for a noise level that is measured).

Law under H0: sigma is not known but measured, see :mod:`.noise_level`, with nu degrees of freedom
and from rows before the window, so T / 2 follows F(2, nu), whose tail is closed:
P = (1 + T / nu)^(-nu / 2). What is reported is the window with the smallest P, as the normal
deviate of the same two-sided probability with the sign of the departure at the window's end. How
often the largest of so many overlapping windows crosses a threshold is :mod:`.alarm_rate`.

Noise with tails heavier than a Gaussian's (the phase of a weak signal) makes short windows worth
less: with an excess kurtosis k of a row, the density of a sum over n rows at the deviate z is
larger by exp(K z^4 / 24), K = k sum(w^4) / sum(w^2)^2 (Edgeworth), so that z counts as
z sqrt(1 - K z^2 / 12). ``TAIL`` k / n stands for K.

What is innocent is taken off both measurements before they are squared, which can only make T
smaller: a drift of the level up to ``drift``, and any course within a band of width ``wander``
(multipath): its mean over a window differs from that before by no more than the width, and its
slope over a window of length W is at most 3 / 2 of the width over W (a step in the middle).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from sdr_spoof.detectors.alarm_rate import threshold_sigmas
from sdr_spoof.detectors.noise_level import NoiseLevel, noise_level
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.detectors.windows import sliding_mean, sliding_slope

TAIL = 3.5
"""n sum(w^4) of a window of n rows: 1 along the jump, 1.8 along the slope, 2.2 along the departure
of the last row; the rest accounts for the terms behind (measured, 30 to 35 dB-Hz)."""


@dataclass(frozen=True)
class Plan:
    """Lengths of a test, in rows."""

    step_s: float
    windows: tuple[int, ...]
    """Ascending."""
    reference: int
    """Longest reference before a window, for level and noise."""
    least_reference: int
    group: int
    """Rows in which the noise is measured about a line of its own."""
    drift: float
    """Innocent drift of the level, in its unit per second."""
    wander: float = 0.0
    """Width of the band within which the level may innocently go to and fro."""

    @classmethod
    def of(
        cls,
        step_s: float,
        windows_s: tuple[float, ...],
        reference_s: tuple[float, float],
        group_s: float,
        drift: float,
        wander: float = 0.0,
    ) -> Plan:
        """From lengths in s; ``reference_s`` is the least and the longest."""
        group = max(round(group_s / step_s), 5)
        least, longest = (max(round(s / step_s), 5 * group) for s in reference_s)
        windows = tuple(sorted({max(round(w / step_s), 3) for w in windows_s}))
        return cls(step_s, windows, max(least, longest), least, group, drift, wander)

    @property
    def shortest(self) -> int:
        """Rows without which nothing is tested."""
        return self.windows[0] + self.least_reference

    def threshold(self, false_alarms_per_hour: float) -> float:
        """Threshold on the normal deviate, see :mod:`.alarm_rate`."""
        return threshold_sigmas(self.windows, self.reference, self.step_s, false_alarms_per_hour)


@dataclass(frozen=True)
class Rows:
    """Equally spaced measurements, M of them, in unbroken pieces."""

    end_s: NDArray[np.float64]
    """End of the signal in each row, shape (M,)."""
    middle_s: NDArray[np.float64]
    values: NDArray[np.float64]
    """NaN where a row is not used."""
    spread: NDArray[np.float64]
    """Variance that C/N0 lets expect, in any unit: where it rises, the noise rises with it."""
    strong: NDArray[np.bool_]
    """Rows with enough C/N0."""
    pieces: tuple[slice, ...]
    first: int
    """Number of the first row in the whole track: sections group the same rows."""
    kurtosis: NDArray[np.float64] | None = None
    """Excess kurtosis of each row's noise, shape (M,); None for Gaussian noise."""


def series(
    rows: Rows,
    plan: Plan,
    lead: int,
    false_alarms_per_hour: float,
    *,
    detector: str,
    system: str,
    prn: int,
    trace_unit: str,
    notes: tuple[str, ...],
    signal: str | None = None,
) -> StatisticSeries:
    """The tests of all pieces; those that end within the first ``lead`` rows are left out."""
    deviate = np.full(rows.values.size, np.nan)
    segment = np.full(rows.values.size, -1)
    for number, piece in enumerate(rows.pieces):
        segment[piece] = number
        first = rows.first + piece.start
        kurtosis = None if rows.kurtosis is None else rows.kurtosis[piece]
        deviate[piece] = deviates(rows.values[piece], rows.spread[piece], plan, first, kurtosis)
    tested = np.isfinite(deviate) & rows.strong
    tested[:lead] = False
    ones = np.ones(int(np.count_nonzero(tested)))
    return StatisticSeries(
        detector=detector,
        system=system,
        prn=prn,
        unit="sigma",
        time_s=rows.end_s[tested],
        value=deviate[tested],
        sigma=ones,
        sigma_thermal=ones,
        segment=segment[tested],
        window_s=plan.windows[-1] * plan.step_s,
        trace_time_s=rows.middle_s,
        trace=rows.values,
        trace_unit=trace_unit,
        trace_segment=segment,
        notes=notes,
        signal=signal,
        shortest_s=plan.windows[0] * plan.step_s,
        threshold_sigmas=plan.threshold(false_alarms_per_hour),
    )


def deviates(
    values: NDArray[np.float64],
    spread: NDArray[np.float64],
    plan: Plan,
    first: int = 0,
    kurtosis: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Signed normal deviate of the most significant window that ends with each row, shape (M,).

    NaN until the shortest window has its reference. ``first`` is the number of row 0 in the whole
    track, to which groups of the noise level are aligned.
    """
    best = np.full(values.size, np.nan)
    if values.size < plan.shortest:
        return best
    level = values - values[0]
    sums = [np.concatenate(([0.0], np.cumsum(v))) for v in (level, spread)]
    noise = noise_level(level, spread, plan.group, plan.reference, plan.least_reference, first)
    for window in plan.windows:
        if window > values.size - plan.least_reference:
            break
        found = _window(level, sums, noise, window, plan)
        if kurtosis is not None:
            found = _lighter(found, sliding_mean(kurtosis, window)[-found.size :] * TAIL / window)
        before = best[-found.size :]
        better = (np.abs(found) > np.abs(before)) | (np.isnan(before) & np.isfinite(found))
        before[better] = found[better]
    return best


def _lighter(deviate: NDArray[np.float64], kurtosis: NDArray[np.float64]) -> NDArray[np.float64]:
    """The deviate of a Gaussian that is as rare; from its half on the correction is held."""
    return np.asarray(deviate * np.sqrt(np.maximum(1.0 - kurtosis * deviate**2 / 12.0, 0.5)))


def _window(
    level: NDArray[np.float64],
    sums: list[NDArray[np.float64]],
    noise: NoiseLevel,
    window: int,
    plan: Plan,
) -> NDArray[np.float64]:
    """Signed deviate of every window of one length that has a reference, in order."""
    start = np.arange(plan.least_reference, level.size - window + 1)
    reference = np.minimum(start, plan.reference)
    before = (sums[0][start] - sums[0][start - reference]) / reference
    mean, expected = ((s[start + window] - s[start]) / window for s in sums)
    variance, freedom = noise.before(start, expected)
    jump = mean - before
    slope = sliding_slope(level, window, plan.step_s)[start]
    end_sign = np.sign(jump + slope * (0.5 * window * plan.step_s))
    lever_s = 0.5 * (window + reference) * plan.step_s
    jump_allowed = plan.drift * lever_s + plan.wander
    slope_allowed = plan.drift + 1.5 * plan.wander / (window * plan.step_s)
    jump_energy = _beyond(jump, jump_allowed) / (1.0 / window + 1.0 / reference)
    slope_energy = _beyond(slope, slope_allowed) * (window * (window**2 - 1.0) / 12.0)
    slope_energy *= plan.step_s**2
    with np.errstate(divide="ignore", invalid="ignore"):
        energy = (jump_energy + slope_energy) / variance
        log_p = -0.5 * freedom * np.log1p(energy / freedom)
        return np.asarray(-end_sign * scipy.special.ndtri_exp(log_p - np.log(2.0)))


def _beyond(
    value: NDArray[np.float64], allowed: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """Square of what exceeds the allowed size."""
    return np.asarray(np.maximum(np.abs(value) - allowed, 0.0) ** 2)
