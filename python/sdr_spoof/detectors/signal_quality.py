"""Signal-quality monitoring: the shape of the correlation peak from early, prompt and late taps.

A metric is a weighted sum of taps over the prompt, m = (w . t) / P, projected on the prompt so that
data and a phase error drop out. Over a window of N epochs it is the ratio of sums

    X = sum Re((w . t) conj(P)) / sum |P|^2,   the noise's own share taken out of both.

What is constant (filter, code bias, static multipath) goes with the mean X_r over a trailing
reference window, which ends where the test window begins.

Laws under H0. The noise of the taps is correlated like the replica: E[n_i conj(n_j)] =
sigma^2 R(tau_i - tau_j). With s = C/N0 T, and the noise that the ratio leaves,
sigma_u^2 = w'Rw - 2 X w'r + X^2, r_i = R(tau_i),

    var X  = (sigma_u^2 / (2 s)) (1 + 1 / s) / N
    mean   : X - X_r ~ N(0, var X + var X_r)
    scatter: V / V_r ~ F(N - 1, N_r - 1), V the sample variance of the epochs' residuals.

To first order and without the prompt's share this is the textbook law: (1 - R(2d)) / (4 C/N0 T)
for delta, as in R. E. Phelts, "Multicorrelator techniques for robust mitigation of threats to GPS
signal quality" (Stanford, 2001), chapter 4, and M. Irsigler and G. Hein, "Development of a
real-time multipath monitor based on multi-correlator observations" (ION GNSS 2005). For spoofing:
A. Cavaleri, B. Motella, M. Pini and M. Fantino, "Detection of spoofed GPS signals at code and
carrier tracking level" (NAVITEC 2010); B. Ledvina, W. Bencze, B. Galusha and I. Miller, "An in-line
anti-spoofing device for legacy civil GPS receivers" (ION ITM 2010); the scatter: C. Sun et al.,
"Moving variance-based signal quality monitoring method for spoofing detection" (GPS Solutions 22,
2018).

Where an epoch scatters more than the noise explains, by the reference itself, the law of the mean
is widened by as much. A test ends with every epoch; the threshold is set for a rate of false alarms
per hour and satellite, which its signals share (:mod:`.alarm_rate`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.detectors.alarm_rate import mean_threshold_sigmas
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.presence import BELOW_DB, empty
from sdr_spoof.detectors.series import StatisticSeries, signals_of
from sdr_spoof.detectors.windows import moving_sum, sections, segments
from sdr_spoof.records import SignalTrack, State, TrackLog

LEAST_REFERENCE = 1.0
"""A reference has at least this many test windows."""
ODDS_FLOOR = 300.0
"""Smallest probability that is turned into standard deviations, as a power of ten."""


@dataclass(frozen=True)
class Metric:
    """A combination of taps around the prompt."""

    name: str
    title: str
    weights: tuple[float, float]
    """Of the early and of the late tap."""
    split_states: bool
    """Whether a change between single and joint tracking moves it: both share one code loop."""


@dataclass(frozen=True)
class Epochs:
    """What one track gives per epoch, M rows."""

    time_s: NDArray[np.float64]
    epoch_s: float
    product: NDArray[np.float64]
    """Re((w . t) conj(P)), with the noise that both share still in it."""
    power: NDArray[np.float64]
    """|P|^2, likewise."""
    noise: NDArray[np.float64]
    """Noise power of a tap."""
    correlation: tuple[float, float]
    """w'Rw, w'r: noise of the combination, and what it shares with the prompt."""
    pieces: tuple[slice, ...]


def statistics(
    metric: Metric, scatter: bool, name: str, log: TrackLog, config: DetectionConfig
) -> Iterator[StatisticSeries]:
    """The metric of every signal, section by section; its mean, or its scatter."""
    window_s, reference_s = config.quality_window_s, config.quality_reference_s
    lead_s = (
        max(config.settle_s, config.quality_settle_s)
        + window_s
        + reference_s
        + config.onset_lookback_s
    )
    for track in log.signals:
        if track.tap_offsets_s.size < 3 or not track.epochs:
            continue
        share = 1.0 / signals_of(log, track)
        for first, stop, lead in sections(track, lead_s):
            part = track.part(first, stop)
            epochs = per_epoch(part, metric, log.sample_rate_hz, config)
            yield _series(epochs, part, metric, scatter, name, share, lead, config)


def per_epoch(
    track: SignalTrack, metric: Metric, sample_rate_hz: float, config: DetectionConfig
) -> Epochs:
    """Products and powers of each epoch, and the pieces of the track that can be tested."""
    at = track.prompt_tap
    taps = track.taps[:, at - 1 : at + 2].astype(np.complex128)
    prompt = taps[:, 1]
    combined = metric.weights[0] * taps[:, 0] + metric.weights[1] * taps[:, 2]
    epoch_s = float(np.median(track.integration_s))
    usable = (
        (track.state >= State.SYNCED)
        & (track.noise_power > 0.0)
        & ~empty(track, config.min_cn0_dbhz - BELOW_DB)
    )
    settle = round(max(config.settle_s, config.quality_settle_s) / epoch_s)
    pieces = [
        slice(piece.start + settle, piece.stop)
        for piece in segments(track.time_s, usable)
        if piece.stop - piece.start > settle
    ]
    if metric.split_states:
        pieces = [part for piece in pieces for part in _of_one_state(track.state, piece, settle)]
    return Epochs(
        time_s=track.time_s,
        epoch_s=epoch_s,
        product=(combined * prompt.conj()).real,
        power=np.abs(prompt) ** 2,
        noise=track.noise_power * sample_rate_hz * track.integration_s,
        correlation=noise_correlation(track, metric),
        pieces=tuple(pieces),
    )


def _of_one_state(state: NDArray[np.uint8], piece: slice, settle: int) -> Iterator[slice]:
    cuts = np.flatnonzero(np.diff(state[piece].astype(np.int64))) + 1 + piece.start
    edges = [piece.start, *(int(c) for c in cuts), piece.stop]
    for number, (start, stop) in enumerate(pairwise(edges)):
        start += settle if number else 0  # noqa: PLW2901
        if stop > start:
            yield slice(start, stop)


def noise_correlation(track: SignalTrack, metric: Metric) -> tuple[float, float]:
    """w'Rw and w'r of a metric's taps, by the autocorrelation of the replica."""
    chip_rate_hz = _core.signal_spec(track.signal)["chip_rate_hz"]
    at = track.prompt_tap
    early, prompt, late = (float(x) * chip_rate_hz for x in track.tap_offsets_s[at - 1 : at + 2])

    def r(delay_chips: float) -> float:
        return _core.early_late(track.modulation, abs(delay_chips) / 2.0)[0]

    a, b = metric.weights
    own = a * a + b * b + 2.0 * a * b * r(late - early)
    return own, a * r(early - prompt) + b * r(late - prompt)


def residual_variance(
    correlation: tuple[float, float], metric: NDArray[np.float64]
) -> NDArray[np.float64]:
    """sigma_u^2: the noise of (w . t) - X P in units of a tap's noise power."""
    own, shared = correlation
    return np.asarray(own - 2.0 * metric * shared + metric**2)


@dataclass(frozen=True)
class _Sums:
    """Sums over windows of one length, K rows."""

    count: NDArray[np.float64]
    metric: NDArray[np.float64]
    """X."""
    snr: NDArray[np.float64]
    """Of one epoch."""
    law: NDArray[np.float64]
    """Variance of X by the law."""
    scatter: NDArray[np.float64]
    """Sample variance of an epoch's residual over its law."""


def _series(
    epochs: Epochs,
    track: SignalTrack,
    metric: Metric,
    scatter: bool,
    name: str,
    share: float,
    lead: int,
    config: DetectionConfig,
) -> StatisticSeries:
    rows = max(round(config.quality_window_s / epochs.epoch_s), 5)
    parts = [
        _tests_in_piece(epochs, number, piece, rows, scatter, lead, config)
        for number, piece in enumerate(epochs.pieces)
        if piece.stop - piece.start >= round((1.0 + LEAST_REFERENCE) * rows)
    ]
    columns = np.concatenate([np.empty((5, 0)), *parts], axis=1)
    trace = np.full(epochs.time_s.size, np.nan)
    trace_segment = np.full(epochs.time_s.size, -1)
    for number, piece in enumerate(epochs.pieces):
        trace[piece] = _trace(epochs, piece, rows, scatter)
        trace_segment[piece] = number
    return StatisticSeries(
        detector=name,
        system=_core.signal_spec(track.signal)["system"],
        prn=track.prn,
        unit="sigma" if scatter else "of the prompt",
        time_s=columns[0],
        value=columns[1],
        sigma=columns[2],
        sigma_thermal=columns[3],
        segment=columns[4].astype(np.int64),
        window_s=config.quality_window_s,
        trace_time_s=epochs.time_s,
        trace=trace,
        trace_unit=f"{metric.title}, " + ("squared residual" if scatter else "of the prompt"),
        trace_segment=trace_segment,
        notes=(),
        signal=track.signal,
        share=share,
        threshold_sigmas=mean_threshold_sigmas(
            rows,
            max(round(config.quality_reference_s / epochs.epoch_s), rows),
            epochs.epoch_s,
            config.false_alarms_per_hour * share,
        ),
    )


def _trace(epochs: Epochs, piece: slice, rows: int, scatter: bool) -> NDArray[np.float64]:
    """The metric of each epoch, or its squared residual, over the mean power of the piece."""
    power = epochs.power[piece]
    level = max(float(np.mean(power - epochs.noise[piece])), 1e-30)
    values = epochs.product[piece] / np.maximum(power, 0.1 * level)
    if not scatter:
        return np.asarray(values)
    return np.asarray((values - np.median(values)) ** 2)


def _tests_in_piece(
    epochs: Epochs,
    number: int,
    piece: slice,
    rows: int,
    scatter: bool,
    lead: int,
    config: DetectionConfig,
) -> NDArray[np.float64]:
    """Columns time, value, sigma, thermal sigma, piece number of the supported windows."""
    least = round(LEAST_REFERENCE * rows)
    most = max(round(config.quality_reference_s / epochs.epoch_s), least)
    size = piece.stop - piece.start
    stop = np.arange(rows + least, size + 1)
    test = _sums(epochs, piece, stop - rows, stop)
    reference = _sums(epochs, piece, np.maximum(stop - rows - most, 0), stop - rows)
    if scatter:
        value = _f_to_normal(test, reference)
        thermal = sigma = np.ones(value.size)
    else:
        value = test.metric - reference.metric
        thermal = np.sqrt(test.law + reference.law)
        sigma = thermal * np.sqrt(np.maximum(reference.scatter, 1.0))
    end = epochs.time_s[piece][stop - 1] + 0.5 * epochs.epoch_s
    least_snr = 10.0 ** (config.min_cn0_dbhz / 10.0) * epochs.epoch_s
    supported = np.minimum(test.snr, reference.snr) >= least_snr
    supported &= piece.start + stop - 1 >= lead
    table = np.vstack([end, value, sigma, thermal, np.full(end.size, float(number))])
    return np.asarray(table[:, supported])


def _sums(epochs: Epochs, piece: slice, start: NDArray[np.int64], stop: NDArray[np.int64]) -> _Sums:
    """Metric, law and scatter over rows [start, stop) of a piece."""
    product, power, noise = epochs.product[piece], epochs.power[piece], epochs.noise[piece]
    own, shared = epochs.correlation

    def total(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return moving_sum(values, start, stop)

    count = (stop - start).astype(np.float64)
    noise_sum = total(noise)
    signal = np.maximum(total(power) - noise_sum, 1e-9 * noise_sum)
    metric = (total(product) - shared * noise_sum) / signal
    snr = signal / noise_sum
    unit = residual_variance((own, shared), metric)
    # Epochs' residuals along the prompt, Re(u conj(P)) / |P|, are normal whatever the prompt.
    along, size = product / np.sqrt(power * noise), np.sqrt(power / noise)
    square = total(along**2) - 2.0 * metric * total(along * size) + metric**2 * total(size**2)
    return _Sums(
        count=count,
        metric=metric,
        snr=snr,
        law=unit / (2.0 * snr) * (1.0 + 1.0 / snr) / count,
        scatter=np.maximum(square, 0.0) / np.maximum(count - 1.0, 1.0) / (0.5 * unit),
    )


def _f_to_normal(test: _Sums, reference: _Sums) -> NDArray[np.float64]:
    """The quotient of two sample variances, as the normal quantile of its F law."""
    ratio = test.scatter / np.maximum(reference.scatter, 1e-30)
    freedom = test.count - 1.0, reference.count - 1.0
    tiny = 10.0**-ODDS_FLOOR
    # Of the two tails the one that is less than about a half keeps its precision.
    high = ratio > 1.0
    quantile = np.empty(ratio.shape)
    for side, tail, sign in ((high, scipy.special.fdtrc, -1.0), (~high, scipy.special.fdtr, 1.0)):
        p = tail(freedom[0][side], freedom[1][side], ratio[side])
        quantile[side] = sign * scipy.special.ndtri(np.maximum(p, tiny))
    return quantile
