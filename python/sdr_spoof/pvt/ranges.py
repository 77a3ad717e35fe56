"""Pseudoranges and rates as the solver takes them: delays out, smoothed, with their noise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.observations import SUBCARRIER
from sdr_spoof.signals import LIGHT_M_S, signal_spec

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.observations import Observations

    from .config import PvtConfig
    from .ephemerides import Choice

REFERENCE_DBHZ = 45.0
SLOW_HZ = 1.1e6
SLOW_NOISE, BOC_NOISE = 2.0, 0.5
"""Noise against B1I's of codes of lower chip rates and of those with a subcarrier. The default
loops give 0.38 m (B1I), 0.8 m (L1CA) and 0.19 m (B1CP) at 45 dB-Hz."""
CODE_MEMORY_S = 0.5
"""Half the reciprocal of the code loop's noise bandwidth, 1 Hz."""
BEAT_SIGNALS = ("B1I", "B1CP")


def carrier_hz(signal: str) -> float:
    """Carrier; of the subcarrier range the one at which the ionosphere delays as much as it."""
    if signal == SUBCARRIER:
        return float(np.sqrt(np.prod([signal_spec(s).carrier_hz for s in BEAT_SIGNALS])))
    return signal_spec(signal).carrier_hz


def ranges_m(observations: Observations, choice: Choice, config: PvtConfig) -> NDArray[np.float64]:
    """Pseudoranges (E, S) without group delays, smoothed if so configured."""
    ranges = observations.pseudorange_m - LIGHT_M_S * group_delay_s(observations, choice)
    if config.smoothing_s:
        ranges = smoothed(observations, ranges, config.smoothing_s)
    if config.subcarrier:
        ranges = with_common_steps(observations, ranges)
    return np.ascontiguousarray(ranges)


def group_delay_s(observations: Observations, choice: Choice) -> NDArray[np.float64]:
    """Of each signal: it leaves the satellite so much later (E, S)."""
    delays = np.zeros(choice.known.shape)
    for column, signal in enumerate(observations.signals):
        own = np.array([e.group_delay_s(signal.signal) for e in choice.ephemerides] + [0.0])
        delays[:, column] = own[choice.known[:, column]]
    return delays


def smoothed(
    observations: Observations, ranges: NDArray[np.float64], constant_s: float
) -> NDArray[np.float64]:
    """Codes smoothed by their carriers where those are unbroken."""
    memory = _memory(observations, constant_s)
    gaps = broken(observations)
    result = ranges.copy()
    for column, signal in enumerate(observations.signals):
        if signal.signal != SUBCARRIER:
            wavelength = LIGHT_M_S / signal_spec(signal.signal).carrier_hz
            carrier_m = observations.carrier_phase_cycles[:, column] * wavelength
            result[:, column] = _core.smooth_code(
                np.ascontiguousarray(ranges[:, column]),
                np.ascontiguousarray(carrier_m),
                np.ascontiguousarray(gaps[:, column]),
                memory,
            )
    return result


def averaged(observations: Observations, constant_s: float) -> NDArray[np.float64]:
    """Independent codes that a smoothed one is the mean of (E, S), at least.

    The noise of a code loop changes within :data:`CODE_MEMORY_S`; codes nearer to one another do
    not count in full.
    """
    beat = np.array([s.signal == SUBCARRIER for s in observations.signals])
    gone = ~np.isfinite(observations.pseudorange_m + observations.carrier_phase_cycles)
    since = np.arange(observations.epochs)[:, None]
    begin = np.maximum.accumulate(np.where(broken(observations) | gone, since, 0), axis=0)
    count = np.minimum(since - begin, _memory(observations, constant_s) - 1)
    share = min(1.0, _interval_s(observations) / CODE_MEMORY_S)
    return np.where(beat | gone, 1.0, 1.0 + count * share)


def _interval_s(observations: Observations) -> float:
    return float(np.median(np.diff(observations.time_s))) if observations.epochs > 1 else 1.0


def _memory(observations: Observations, constant_s: float) -> int:
    """Epochs that the mean reaches back."""
    return max(1, round(constant_s / _interval_s(observations)))


def broken(observations: Observations) -> NDArray[np.bool_]:
    """Where the carrier may not be the continuation of the epoch before (E, S)."""
    times, half = observations.time_s, observations.half_cycle
    gaps = np.diff(times, prepend=times[:1]) > 1.5 * _interval_s(observations)
    return observations.lock_lost | gaps[:, None] | np.diff(half, axis=0, prepend=half[:1])


def with_common_steps(
    observations: Observations, ranges: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Subcarrier ranges on one common step against the code.

    Each may miss steps of its ambiguity. The bias of the receiver between the bands is the same
    for all satellites: the fraction of a step by which they differ from the codes, on a circular
    mean, tells it, and each goes to the step nearest to it.
    """
    lower, upper = (signal_spec(s).carrier_hz for s in BEAT_SIGNALS)
    columns = observations.columns(SUBCARRIER)
    half = bool(observations.half_cycle[:, columns].any())
    step = LIGHT_M_S / (upper - lower) * (0.5 if half else 1.0)
    runs = [
        (column, rows, float(np.median(difference[rows])))
        for column in columns
        for difference in [ranges[:, column] - _code_mean(observations, ranges, column)]
        for rows in _unbroken(difference, step)
    ]
    if not runs:
        return ranges
    weights = np.array([rows.size for _, rows, _ in runs])
    turns = np.array([level for *_, level in runs]) / step
    common = np.angle(np.sum(weights * np.exp(2j * np.pi * turns))) / (2 * np.pi)
    result = ranges.copy()
    for (column, rows, _), turn in zip(runs, turns, strict=True):
        result[rows, column] -= step * np.round(turn - common)
    return result


def _code_mean(
    observations: Observations, ranges: NDArray[np.float64], column: int
) -> NDArray[np.float64]:
    """Mean of the codes of that satellite's two signals, NaN where one is missing."""
    name = observations.signals[column].satellite
    own = [
        k
        for k, s in enumerate(observations.signals)
        if s.satellite == name and s.signal in BEAT_SIGNALS
    ]
    if len(own) < len(BEAT_SIGNALS):
        return np.full(observations.epochs, np.nan)
    return np.asarray(ranges[:, own].mean(axis=1))


def _unbroken(difference: NDArray[np.float64], step: float) -> list[NDArray[np.intp]]:
    """Runs of epochs in which the difference does not jump by half a step."""
    rows = np.flatnonzero(np.isfinite(difference))
    if not rows.size:
        return []
    jumps = (np.diff(rows) > 1) | (np.abs(np.diff(difference[rows])) > 0.5 * step)
    return np.split(rows, np.flatnonzero(jumps) + 1)


def variance_m2(observations: Observations, config: PvtConfig) -> NDArray[np.float64]:
    """Assumed variance of each pseudorange (E, S), but for what grows towards the horizon."""
    sigma = np.array([code_sigma_m(s.signal, config) for s in observations.signals])
    variance = sigma**2 * _by_cn0(observations, config)
    if config.smoothing_s:
        variance /= averaged(observations, config.smoothing_s)
    if observations.unsettled_m is not None:
        variance += np.nan_to_num(observations.unsettled_m) ** 2
    return np.ascontiguousarray(variance)


def rate_variance(observations: Observations, config: PvtConfig) -> NDArray[np.float64]:
    """Assumed variance of each Doppler (E, S) in m^2/s^2."""
    return np.ascontiguousarray(config.doppler_sigma_m_s**2 * _by_cn0(observations, config))


def _by_cn0(observations: Observations, config: PvtConfig) -> NDArray[np.float64]:
    if config.weights not in ("cn0", "cn0-elevation"):
        return np.ones(observations.cn0_dbhz.shape)
    return np.asarray(10.0 ** ((REFERENCE_DBHZ - observations.cn0_dbhz) / 10.0))


def code_sigma_m(signal: str, config: PvtConfig) -> float:
    """Assumed noise of a signal's pseudorange at 45 dB-Hz."""
    if signal == SUBCARRIER:
        return config.subcarrier_sigma_m
    spec = signal_spec(signal)
    if "BOC" in spec.modulation.upper():
        return config.code_sigma_m * BOC_NOISE
    return config.code_sigma_m * (SLOW_NOISE if spec.chip_rate_hz < SLOW_HZ else 1.0)


def rates_m_s(observations: Observations) -> NDArray[np.float64]:
    """Rates of the pseudoranges (E, S) by Doppler; positive Doppler means approach."""
    wavelengths = np.array([LIGHT_M_S / carrier_hz(s.signal) for s in observations.signals])
    return np.ascontiguousarray(-observations.doppler_hz * wavelengths)
