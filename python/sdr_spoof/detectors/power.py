"""Rises of power: of the prompt, of the band's noise, and of the one over the other.

A spoofer needs power: to take a receiver over it must be about as strong as the satellite, or it
raises the noise first. Three quantities of each signal, in dB over their largest window within a
trailing reference (a fall, and the return from it, are what trees and houses do, and no evidence):

* ``C/N0``: prompt over noise;
* ``noise power``: in-band power beside the signal, by the noise tap, which code of any satellite
  hardly reaches; over ``power_noise_floor`` where the user has calibrated one;
* ``C/N0 against power``: the power-distortion idea. What raises the in-band power by x dB without
  being the satellite must lower C/N0 by x dB. The deviation from that, d(C/N0) + d(noise), is here
  nothing else than the rise of the prompt's absolute power; interference leaves it alone, a spoofer
  that hides its C/N0 under noise of its own does not.

A fourth, the noise floor of the band, is that of all satellites together (:mod:`.noise_floor`).

Behind an automatic gain control (``log.gain``) prompt and noise are divided by the gain, the noise,
which is a running mean, by the running mean of it: they are those at the antenna. A control whose
gain nobody wrote down keeps the noise as it is, so that noise power and noise floor say nothing and
C/N0 against power becomes C/N0; C/N0 needs no gain, beyond the memory of the noise.

Law under H0. The window's mean |P|^2 - noise over N epochs has the relative variance
(2 / s + 1 / s^2) / N, s = C/N0 T. The tracker's noise power is an exponential mean with memory m of
slices dt, each with relative variance 1; averaged over a window W that is
(dt / W) (1 - (m / W) (1 - exp(-W / m))). 10 / ln 10 makes them dB; those of window and reference
add. Innocent power wanders too (multipath, attitude, elevation): the deviation ``power_wander_db``
is added in squares. Since the reference is the *largest* of its windows, P(value > x) under H0 is
at most that of N(0, sigma^2); values below 0 are given as 0. A rise over the largest window is one
over the window just before, so that clumps of alarms are no more than those of a mean against a
reference of its own length, which sets the threshold for a rate of false alarms per hour and
satellite (:mod:`.alarm_rate`), shared by its signals and quantities.

Sources: K. Wesson, J. Gross, T. Humphreys and B. Evans, "GNSS signal authentication via power and
distortion monitoring" (IEEE Transactions on Aerospace and Electronic Systems 54, 2018); D. Akos,
"Who's afraid of the spoofer? GPS/GNSS spoofing detection via automatic gain control" (Navigation
59, 2012); variance: that of a non-central chi-square with 2 degrees of freedom.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.detectors import noise_floor
from sdr_spoof.detectors.alarm_rate import mean_threshold_sigmas
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.noise_floor import DB, NOISE_MEMORY_S, ChannelBins, noise_variance
from sdr_spoof.detectors.presence import BELOW_DB, empty
from sdr_spoof.detectors.series import StatisticSeries, signals_of
from sdr_spoof.detectors.windows import sections, segments, sliding_mean
from sdr_spoof.gain import GainLog
from sdr_spoof.records import SignalTrack, State, TrackLog

NAME = "power"
CN0, NOISE, AGAINST = "C/N0", "noise power", "C/N0 against power"


@dataclass(frozen=True)
class _Rows:
    """Usable epochs of a track, one after the other, whatever gap lies between; M rows."""

    at: NDArray[np.int64]
    """Row in the track."""
    piece: NDArray[np.int64]
    signal: NDArray[np.float64]
    """Prompt power per sample, with its noise taken out."""
    noise: NDArray[np.float64]
    """Noise power per sample, the tracker's running mean."""
    in_prompt: NDArray[np.float64]
    """Mean noise power in the prompt of an epoch, per sample."""


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The rises of every signal, section by section, then those of the bands."""
    channels = []
    lead_s = config.power_window_s + config.power_reference_s + config.onset_lookback_s
    for track in log.signals:
        if not track.epochs:
            continue
        share = 1.0 / (4.0 * signals_of(log, track))
        channels.append(ChannelBins(track))
        for first, stop, lead in sections(track, lead_s):
            part = track.part(first, stop)
            rows, epoch_s = _rows(part, log.sample_rate_hz, config, log.gain)
            for quantity in (CN0, NOISE, AGAINST):
                yield _series(part, rows, epoch_s, quantity, share, lead, config)
            _gather(channels[-1], part, rows, lead)
    yield from noise_floor.statistics(log, channels, config, 0.25)


def _gather(channel: ChannelBins, track: SignalTrack, rows: _Rows, lead: int) -> None:
    """Epochs of a section, once the running mean of the noise is no longer a short one."""
    time_s = track.time_s[rows.at]
    since_s = time_s - time_s[np.searchsorted(rows.piece, rows.piece)]
    kept = (rows.at >= lead) & (since_s >= NOISE_MEMORY_S)
    channel.add(time_s[kept], rows.noise[kept], rows.signal[kept])


def _rows(
    track: SignalTrack,
    sample_rate_hz: float,
    config: DetectionConfig,
    gain: GainLog | None = None,
) -> tuple[_Rows, float]:
    epoch_s = float(np.median(track.integration_s))
    samples = sample_rate_hz * track.integration_s
    usable = (
        (track.state >= State.SYNCED)
        & (track.noise_power > 0.0)
        & ~empty(track, config.min_cn0_dbhz - BELOW_DB)
    )
    settle = round(config.settle_s / epoch_s)
    pieces = [
        np.arange(piece.start + settle, piece.stop) for piece in segments(track.time_s, usable)
    ]
    none = np.empty(0, np.int64)
    at = np.concatenate([none, *pieces])
    number = np.concatenate([none, *(np.full(p.size, k) for k, p in enumerate(pieces))])
    noise = track.noise_power
    prompt = np.abs(track.taps[:, track.prompt_tap].astype(np.complex128)) ** 2 / samples**2
    if gain is not None:
        noise = noise / gain.remembered_power(track.time_s + 0.5 * epoch_s)
        prompt = prompt / gain.power(track.time_s)
    in_prompt = noise / samples
    return _Rows(at, number, (prompt - in_prompt)[at], noise[at], in_prompt[at]), epoch_s


def _series(
    track: SignalTrack,
    rows: _Rows,
    epoch_s: float,
    quantity: str,
    share: float,
    lead: int,
    config: DetectionConfig,
) -> StatisticSeries:
    width = max(round(config.power_window_s / epoch_s), 5)
    empty_rows = np.empty(0)
    time, value, sigma, thermal = empty_rows, empty_rows, empty_rows, empty_rows
    segment = np.empty(0, np.int64)
    if rows.at.size >= 2 * width:
        level, variance = _level(rows, width, epoch_s, quantity)
        reach = max(round(config.power_reference_s / epoch_s), width)
        value, thermal = _rise(level, variance, width, reach, quantity, config)
        sigma = np.hypot(thermal, config.power_wander_db)
        last = rows.at[2 * width - 1 :]
        time, segment = track.time_s[last] + 0.5 * epoch_s, rows.piece[2 * width - 1 :]
        kept = last >= lead
        time, segment = time[kept], segment[kept]
        value, sigma, thermal = value[kept], sigma[kept], thermal[kept]
    trace, trace_segment = _trace(track, rows, quantity)
    return StatisticSeries(
        detector=NAME,
        system=_core.signal_spec(track.signal)["system"],
        prn=track.prn,
        unit="dB",
        time_s=time,
        value=value,
        sigma=sigma,
        sigma_thermal=thermal,
        segment=segment,
        window_s=config.power_window_s,
        trace_time_s=track.time_s,
        trace=trace,
        trace_unit=f"{quantity}, relative to its median",
        trace_segment=trace_segment,
        notes=(),
        signal=track.signal,
        quantity=quantity,
        share=share,
        threshold_sigmas=mean_threshold_sigmas(
            width, width, epoch_s, config.false_alarms_per_hour * share, sides=1
        ),
    )


def _level(
    rows: _Rows, width: int, epoch_s: float, quantity: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Quantity of every window in dB and its variance by the law, in dB squared."""
    signal, noise = sliding_mean(rows.signal, width), sliding_mean(rows.noise, width)
    in_prompt = sliding_mean(rows.in_prompt, width)
    signal = np.maximum(signal, 0.1 * in_prompt)
    snr = signal / in_prompt
    of_signal = (2.0 / snr + 1.0 / snr**2) / width
    of_noise = np.full(snr.size, noise_variance(width * epoch_s))
    level, variance = {
        CN0: (signal / noise, of_signal + of_noise),
        NOISE: (noise, of_noise),
        AGAINST: (signal, of_signal),
    }[quantity]
    return DB * np.log(level), DB**2 * variance


def _rise(
    level: NDArray[np.float64],
    variance: NDArray[np.float64],
    width: int,
    reach: int,
    quantity: str,
    config: DetectionConfig,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rise over the reference and its standard deviation, for windows from the width-th on."""
    if quantity == NOISE and config.power_noise_floor is not None:
        over = level[width:] - DB * np.log(config.power_noise_floor)
        return np.maximum(over, 0.0), np.sqrt(variance[width:])
    # The largest of the windows that end where the test window begins, or up to `reach` earlier.
    windows = max(reach - width + 1, 1)
    largest = scipy.ndimage.maximum_filter1d(
        level, windows, mode="constant", cval=-np.inf, origin=(windows - 1) // 2
    )
    rise = level[width:] - largest[:-width]
    return np.maximum(rise, 0.0), np.sqrt(variance[width:] + variance[:-width])


def _trace(
    track: SignalTrack, rows: _Rows, quantity: str
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The quantity of each epoch over its median, and the piece that it lies in."""
    trace, segment = np.full(track.epochs, np.nan), np.full(track.epochs, -1)
    values = {
        CN0: rows.signal / rows.noise,
        NOISE: rows.noise,
        AGAINST: rows.signal,
    }[quantity]
    if values.size:
        trace[rows.at] = values / max(abs(float(np.median(values))), 1e-30)
        segment[rows.at] = rows.piece
    return trace, segment
