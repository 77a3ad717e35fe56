"""Drags on random flights through the strapdown computer, by ``rate_drag`` and ``rate_local``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2, norm

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.detectors import budget, growth, local_mean, rate_drag, rate_local
from sdr_spoof.aiding.detectors.changes import at_states
from sdr_spoof.aiding.detectors.drag_filter import Displacements, search
from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.aiding.rate_config import RateConfig
from sdr_spoof.scenario.sky import earth

from . import published
from .flights import ACROSS_M_S2, BETWEEN_S, flight
from .simulated import dilution
from .strapdown_runs import RATE_HZ, imu

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.strapdown import RunStates

    Floats = NDArray[np.float64]

CARRIER_M = 0.005
FIRST_S, LAST_S = 10, 1740
"""Drags begin between; the search tests from 5 s on."""
BASELINE, MEAN = 60, 10
"""Of the local test, seconds."""
PATIENCE_S = 60
"""What is not found by then is missed."""
LEVELS_PER_HOUR = (3.6, 1.0, 0.1, 0.01)
TURNING_RAD = 0.02
"""Change of heading over a second above which a flight turns."""
PERFECT = {"align_velocity_m_s": 0.001, "align_level_deg": 1e-4, "align_heading_deg": 1e-4}
"""As published: aligned perfectly, as good as; position to 3 m."""


@dataclass(frozen=True)
class Case:
    """What is flown."""

    grade: str
    drags_m_s: tuple[float, ...]
    """Each with as many runs as there are onsets."""
    imus: int
    """IMUs of the grade on each flight."""
    onsets: int
    """Runs for each IMU and drag, with onsets and directions of their own."""
    flight: int
    between_s: float = BETWEEN_S
    across_m_s2: tuple[float, float] = ACROSS_M_S2
    first_s: int = FIRST_S
    """Earliest onset."""


@dataclass(frozen=True)
class Flown:
    """One flight with all its runs: GNSS minus INS positions, Earth-fixed, at whole seconds."""

    config: RateConfig
    states: RunStates
    axes: Floats
    """East, north, up, (M, 3, 3)."""
    noise_m: Floats
    """Of the resolved phases, (IMUs, runs, M, 3)."""
    clean_m: Floats
    """(IMUs, runs, M, 3)"""
    attacked_m: Floats
    """(IMUs, drags * runs, M, 3)"""
    onset: NDArray[np.int64]
    """(IMUs, drags, runs)"""
    turning: NDArray[np.bool_]
    """Whether the flight turns at each second, (M,)."""


@dataclass(frozen=True)
class Judged:
    """One detector on one flight."""

    hours: float
    """Clean, tested."""
    alarms: tuple[int, ...]
    """Clean alarms at ``LEVELS_PER_HOUR``; those within an onset window count once."""
    delay_s: Floats
    """From onset to alarm at 0.01 alarms an hour, infinite if missed, (IMUs, drags, runs)."""
    early: int
    """Alarms before the drag, of all attacked runs."""


@dataclass(frozen=True)
class Outcome:
    """Of one flight."""

    drag: Judged
    """``rate_drag``"""
    local: Judged
    """``rate_local``; it tests from 70 s on."""
    turning: NDArray[np.bool_]
    """Whether the flight turned at the onset, (IMUs, drags, runs)."""
    onset_s: Floats


def flown(case: Case, seed: int) -> Flown:
    """One flight, clean and with every drag."""
    config = RateConfig(grade=case.grade, carrier_sigma_m=CARRIER_M, **PERFECT)
    way = flight(case.flight, case.between_s, case.across_m_s2)
    log = ideal_increments(way, published.DURATION_S, RATE_HZ)
    errors = [imu(case.grade, case.flight * case.imus + run, seed) for run in range(case.imus)]
    states = strapdown.navigate_runs(log, true_states(way, np.zeros(1)), errors, every=RATE_HZ)
    true = true_states(way, states.time_s)
    rng = np.random.default_rng([seed, case.flight])
    axes = earth.enu_axes(true.position_m)
    noise = _noise(rng, axes, (case.imus, case.onsets))
    clean = noise - (states.position_m - true.position_m)[:, None]
    attacked, onset = _attacked(rng, clean, axes, case)
    heading = np.unwrap(true.attitude_rad[:, 0])
    turning = np.abs(np.gradient(heading)) > TURNING_RAD
    return Flown(config, states, axes, noise, clean, attacked, onset, turning)


def fly(case: Case, seed: int) -> Outcome:
    """One flight with all its runs, through ``rate_drag`` and ``rate_local``."""
    of = flown(case, seed)
    drag_levels = [float(chi2.isf(h / 3600 / rate_drag.INDEPENDENT, 3)) for h in LEVELS_PER_HOUR]
    local_levels = [float(norm.isf(h / 3600 / 3 / 2)) for h in LEVELS_PER_HOUR]
    return Outcome(
        _judged(of, searched, drag_levels),
        _judged(of, local_with_covariance, local_levels),
        of.turning[of.onset],
        of.onset.astype(float),
    )


def _judged(
    of: Flown, statistic: Callable[[Flown, Floats], Floats], levels: Sequence[float]
) -> Judged:
    """One detector; its thresholds for ``LEVELS_PER_HOUR``, the last one in use."""
    quiet, found = statistic(of, of.clean_m), statistic(of, of.attacked_m)
    window = round(of.config.onset_window_s)
    return Judged(
        float(np.isfinite(quiet).sum() / 3600),
        tuple(_clumps(quiet, level, window) for level in levels),
        *delays(found, of.onset, levels[-1]),
    )


def _noise(rng: np.random.Generator, axes: Floats, runs: tuple[int, int]) -> Floats:
    """Noise of resolved phases, Earth-fixed, (IMUs, runs, M, 3)."""
    root = np.linalg.cholesky(dilution()) * CARRIER_M
    local = rng.standard_normal((*runs, len(axes), 3)) @ root.T
    return np.asarray(np.einsum("mij,krmi->krmj", axes, local))


def _attacked(
    rng: np.random.Generator, clean: Floats, axes: Floats, case: Case
) -> tuple[Floats, NDArray[np.int64]]:
    """The same runs with each drag, in random horizontal directions, and where they begin."""
    shape = (len(clean), len(case.drags_m_s), clean.shape[1])
    onset = rng.integers(case.first_s, LAST_S, shape)
    angle = rng.uniform(0.0, 2 * np.pi, shape)
    local = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    local *= np.array(case.drags_m_s)[:, None, None]
    drag = np.einsum("kdrij,kdri->kdrj", axes[onset], local)
    since = np.clip(np.arange(len(axes)) - onset[..., None], 0, None)
    runs = clean[:, None] + since[..., None] * drag[..., None, :]
    return runs.reshape(len(clean), -1, len(axes), 3), onset


def steps_of(of: Flown) -> growth.Steps:
    """What the model of the INS says of each IMU's run, (IMUs, M, ...)."""
    return growth.steps(at_states(of.states), of.states.time_s, budget.of(of.config))


def searched(of: Flown, position: Floats) -> Floats:
    """GNSS minus INS positions (IMUs, R, M, 3) through the filter, as the detector does it."""
    time_s, axes = of.states.time_s, of.axes
    phase = np.swapaxes(axes, 1, 2) @ (dilution() * CARRIER_M**2) @ axes
    given = Displacements(
        time_s,
        np.diff(position, axis=2, prepend=position[:, :, :1]),
        np.broadcast_to(phase, (len(position), *phase.shape)),
        np.arange(time_s.size) == 1,
        np.arange(time_s.size) > 0,
        np.ones(time_s.size, bool),
    )
    return search(given, steps_of(of), round(of.config.onset_window_s)).statistic


def local_with_covariance(of: Flown, position: Floats) -> Floats:
    """GNSS minus INS positions (IMUs, R, M, 3) through ``rate_local``: its largest axis."""
    steps = steps_of(of)
    covariance = growth.covariances(steps)
    sigma = np.stack([_local_sigma(of, steps, covariance, k) for k in range(len(covariance))])
    value = local_mean.statistic(rates(of, position), MEAN, BASELINE)
    return np.asarray((np.abs(value) / sigma[:, None]).max(axis=2))


def _local_sigma(of: Flown, steps: growth.Steps, covariance: Floats, imu: int) -> Floats:
    """Of one INS, in deviations of one rate, (3, M)."""
    one = growth.Steps(
        steps.transition[imu], steps.noise[imu], steps.start[imu], steps.gained[imu], steps.aligned
    )
    drift = rate_local.ins_variance(one, covariance[imu], MEAN, BASELINE)
    carried = np.einsum("mij,mjl,mil->im", of.axes, drift, of.axes) / noise_m_s()[:, None] ** 2
    return np.asarray(np.sqrt(local_mean.variance_factor(MEAN, BASELINE) + carried))


def rates(of: Flown, position: Floats) -> Floats:
    """East, north, up over their noise, (K, R, 3, M); NaN at the first second."""
    moved = np.diff(position, axis=2, prepend=np.nan)
    local = np.einsum("mij,krmj->krim", of.axes, moved)
    return np.asarray(local / noise_m_s()[:, None])


def noise_m_s() -> Floats:
    """Of the rate over a second, two phases, east, north, up (3,)."""
    return np.asarray(np.sqrt(2 * np.diag(dilution())) * CARRIER_M)


def _clumps(statistic: Floats, level: float, window: int) -> int:
    """Alarms, those within a window of another one counted once."""
    above = (np.nan_to_num(statistic) > level).reshape(-1, statistic.shape[-1])
    total = np.cumsum(above, axis=1)
    before = np.pad(total, ((0, 0), (window + 1, 0)))[:, : total.shape[1]]
    last = np.pad(total, ((0, 0), (1, 0)))[:, : total.shape[1]]
    return int((above & (last == before)).sum())


def delays(statistic: Floats, onset: NDArray[np.int64], level: float) -> tuple[Floats, int]:
    """From each onset to the alarm, infinite if missed; and how many alarms were earlier."""
    above = np.nan_to_num(statistic).reshape(*onset.shape, -1) > level
    second = np.arange(above.shape[-1])
    early = (above & (second <= onset[..., None])).any(axis=-1)
    after = (second > onset[..., None]) & (second <= onset[..., None] + PATIENCE_S)
    hit = above & after
    delay = np.where(hit.any(axis=-1), hit.argmax(axis=-1) - onset, np.inf)
    return delay, int(early.sum())
