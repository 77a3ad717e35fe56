"""The noise floor of a band, by the noise taps of all its satellites together.

One noise tap sees a rise of some tenths of a dB in seconds; the mean of n independent ones is
sqrt(n) times as good, and what all see alike is no matter of one satellite. Interference raises the
floor while the satellites keep their power, and so do counterfeit signals that are too strong and
lie elsewhere in code or Doppler ("asynchronous"): as noise is all that a receiver notices of them
that does not search again.

The statistic is the mean over the channels of a carrier of d(noise), in dB, mean of a window over
mean of the reference before it, less the size of the median change of the prompts' power: a gain
moves both alike, a roof takes power away. Negative values are given as 0.

Law under H0. That of :func:`noise_variance` for window and reference, over n channels: the taps
hear different codes, so that their noise is independent. Window and reference share some of the
tracker's memory, which makes their difference quieter; what is taken off makes the value smaller:
P(value > x) is at most that of N(0, sigma^2). Innocent changes of the floor (temperature, what the
antenna looks at, satellites that rise) have the deviation ``power_floor_wander_db``. The threshold
is that of a rate of false alarms per hour and satellite (:mod:`.alarm_rate`).

Source: D. Akos, "Who's afraid of the spoofer? GPS/GNSS spoofing detection via automatic gain
control" (Navigation 59, 2012), for the noise floor as evidence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.detectors.alarm_rate import mean_threshold_sigmas
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries, signals_of
from sdr_spoof.detectors.windows import moving_sum
from sdr_spoof.records import SignalTrack, TrackLog
from sdr_spoof.signals import signal_spec

QUANTITY = "noise floor of the band"
SLICE_S, NOISE_MEMORY_S = 1e-3, 2.0
"""The tracker averages the noise tap of slices over such a memory (``track/quality.rs``)."""
CAUSE = (
    "interference, or a second set of signals that is too strong; "
    "it takes a search for second peaks to tell"
)
"""What may be behind it, in words."""
BIN_S = 0.5
"""Means are kept of so much signal: 16 bytes a channel."""
MIN_CHANNELS = 2
"""One channel alone has a test of its own (:mod:`.power`)."""
DB = 10.0 / np.log(10.0)


def noise_variance(window_s: float) -> float:
    """Relative variance of the tracker's noise power, averaged over a window."""
    memory = NOISE_MEMORY_S / window_s
    return SLICE_S / window_s * (1.0 - memory * (1.0 - float(np.exp(-1.0 / memory))))


@dataclass
class ChannelBins:
    """Sums over bins of time of one channel, filled section by section; B bins."""

    track: SignalTrack
    sums: NDArray[np.float64] = field(default_factory=lambda: np.zeros((3, 0)))
    """Epochs, noise power and prompt power in each bin, shape (3, B)."""

    def add(
        self, time_s: NDArray[np.float64], noise: NDArray[np.float64], signal: NDArray[np.float64]
    ) -> None:
        """Epochs whose loops and noise power have settled."""
        if not time_s.size:
            return
        bins = (time_s / BIN_S).astype(np.int64)
        count = max(int(bins.max()) + 1, self.sums.shape[1])
        grown = np.zeros((3, count))
        grown[:, : self.sums.shape[1]] = self.sums
        weights = (np.ones(time_s.size), noise, signal)
        grown += [np.bincount(bins, w, count) for w in weights]
        self.sums = grown

    def means(self, count: int) -> NDArray[np.float64]:
        """Noise and prompt power of so many bins, NaN where less than half is there; (2, B)."""
        sums = np.zeros((3, count))
        sums[:, : self.sums.shape[1]] = self.sums
        full = 0.5 * sums[0].max(initial=1.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(sums[0] >= full, sums[1:] / sums[0], np.nan)


@dataclass(frozen=True)
class _Floor:
    """The test of one carrier at the end of every bin from the first on; B bins, K channels."""

    value: NDArray[np.float64]
    thermal: NDArray[np.float64]
    took_part: NDArray[np.bool_]
    """Channels that a bin's test rests on, shape (K, B)."""
    trace: NDArray[np.float64]
    """Mean noise of the bin over each channel's median, in dB; NaN without any."""


def statistics(
    log: TrackLog, channels: list[ChannelBins], config: DetectionConfig, share: float
) -> Iterator[StatisticSeries]:
    """The test of each carrier, for each satellite that took part in it.

    ``share`` is the part of a satellite's false alarms that its signals may make in it.
    """
    carriers: dict[float, list[ChannelBins]] = {}
    for channel in channels:
        carriers.setdefault(signal_spec(channel.track.signal).carrier_hz, []).append(channel)
    for together in carriers.values():
        if len(together) >= MIN_CHANNELS:
            floor = _floor(together, config)
            for took_part, channel in zip(floor.took_part, together, strict=True):
                part = share / signals_of(log, channel.track)
                yield _series(channel.track, floor, took_part, part, config)


def _floor(channels: list[ChannelBins], config: DetectionConfig) -> _Floor:
    count = max(c.sums.shape[1] for c in channels)
    means = np.stack([c.means(count) for c in channels], axis=1)  # (2, K, B)
    window, reach = _lengths(config)
    rise_db, usable = _rises(means, window, reach)
    n = usable.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        noise_db = np.where(usable, rise_db[0], 0.0).sum(axis=0) / n
        power_db = np.zeros(count)
        power_db[n > 0] = np.nanmedian(np.where(usable, rise_db[1], np.nan)[:, n > 0], axis=0)
        variance = noise_variance(window * BIN_S) + noise_variance(reach * BIN_S)
        thermal = DB * np.sqrt(variance / n)
    tested = n >= MIN_CHANNELS
    value = np.where(tested, np.maximum(noise_db - np.abs(power_db), 0.0), np.nan)
    return _Floor(value, thermal, usable & tested, _trace(means[0]))


def _lengths(config: DetectionConfig) -> tuple[int, int]:
    """Bins of the window and of the reference."""
    window = max(round(config.power_floor_window_s / BIN_S), 1)
    return window, max(round(config.power_reference_s / BIN_S), window)


def _rises(
    means: NDArray[np.float64], window: int, reach: int
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Window over reference in dB, shape (2, K, B), and where both are there, (K, B).

    Row B is the window that ends with that bin. Of the reference, half must be there.
    """
    bins = np.arange(means.shape[2])
    stop, start = bins + 1, np.maximum(bins + 1 - window, 0)
    before = np.maximum(start - reach, 0)
    there = np.isfinite(means[0])
    filled = np.nan_to_num(means)

    def over(
        rows: NDArray[np.float64], a: NDArray[np.int64], b: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        return np.apply_along_axis(moving_sum, -1, rows, a, b)

    here, past = over(1.0 * there, start, stop), over(1.0 * there, before, start)
    usable = (here == window) & (past >= 0.5 * reach)
    with np.errstate(invalid="ignore", divide="ignore"):
        now, then = over(filled, start, stop) / here, over(filled, before, start) / past
        return DB * np.log(np.maximum(now, 1e-30) / np.maximum(then, 1e-30)), usable


def _trace(noise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean over the channels of the noise over each one's median, in dB, shape (B,)."""
    heard = np.isfinite(noise).any(axis=1)
    level = np.nanmedian(noise[heard], axis=1, keepdims=True) if heard.any() else noise[:0]
    trace = np.full(noise.shape[1], np.nan)
    some = np.isfinite(noise).any(axis=0)
    trace[some] = DB * np.nanmean(np.log(noise[heard][:, some] / level), axis=0)
    return trace


def _series(
    track: SignalTrack,
    floor: _Floor,
    took_part: NDArray[np.bool_],
    share: float,
    config: DetectionConfig,
) -> StatisticSeries:
    window, reach = _lengths(config)
    rows = np.flatnonzero(took_part)
    piece = np.asarray(np.cumsum(np.diff(rows, prepend=rows[:1]) > 1), np.int64)
    ends_s = np.asarray((np.arange(floor.value.size) + 1) * BIN_S, np.float64)
    thermal = floor.thermal[rows]
    known = np.isfinite(floor.trace)
    return StatisticSeries(
        detector="power",
        system=signal_spec(track.signal).system,
        prn=track.prn,
        unit="dB",
        time_s=ends_s[rows],
        value=floor.value[rows],
        sigma=np.hypot(thermal, config.power_floor_wander_db),
        sigma_thermal=thermal,
        segment=piece,
        window_s=window * BIN_S,
        trace_time_s=ends_s - 0.5 * BIN_S,
        trace=floor.trace,
        trace_unit=f"dB, {QUANTITY} over its median",
        trace_segment=_pieces(piece, rows, known),
        notes=(),
        signal=track.signal,
        quantity=QUANTITY,
        share=share,
        threshold_sigmas=mean_threshold_sigmas(
            window, reach, BIN_S, config.false_alarms_per_hour * share, sides=1
        ),
    )


def _pieces(
    piece: NDArray[np.int64], rows: NDArray[np.int64], known: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Piece of each bin of the trace: that of the next test, whose past it is; -1 without."""
    if not rows.size:
        return np.full(known.size, -1)
    following = np.minimum(np.searchsorted(rows, np.arange(known.size)), rows.size - 1)
    return np.where(known, piece[following], -1)
