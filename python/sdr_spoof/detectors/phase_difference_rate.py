"""Rate of the carrier-scaled phase difference of the two sidebands of one satellite.

Physics: both carriers come from one clock and travel one path, so phi_u - (f_u / f_l) phi_l
(cycles at f_u) stands still whatever the satellite, the user and the receiver clock do. A spoofer
that drags one of them away turns it. The statistic is the least-squares slope of that difference
over a sliding window, in Hz; a constant inter-band bias drops out, the ionosphere leaks 0.016
cycle per TECU.

Law under H0: the measured phase (oscillator plus discriminator) is white from epoch to epoch, so
the slope is N(0, sigma^2) with the thermal law of :func:`thermal_sigma_hz`. The default threshold
uses the wider law of the published loop model instead, see :mod:`.combo_model`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.detectors.combo_model import difference_sigma_hz, fll_sigma_hz
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.phase_difference import (
    Difference,
    epoch_of,
    phase_sigma_cycles,
    ratio_hz,
    scaled_difference,
)
from sdr_spoof.detectors.presence import combo_sections
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.detectors.slips import repair_slips
from sdr_spoof.detectors.windows import sliding_mean, sliding_slope, slope_sigma
from sdr_spoof.records import ComboTrack, TrackLog

NAME = "phase_difference_rate"


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The statistic of every satellite that is tracked in both bands, section by section."""
    lead_s = config.settle_s + config.window_s + config.onset_lookback_s
    for part, there, lead, _ in combo_sections(log, config, lead_s):
        yield statistic(part, config, there, lead)


def statistic(
    track: ComboTrack,
    config: DetectionConfig,
    there: NDArray[np.bool_] | None = None,
    lead: int = 0,
) -> StatisticSeries:
    """Slope of the carrier-scaled phase difference over a sliding window, with its law.

    Rows that are not ``there``, shape (M,), had no signal and are left out. Windows that end
    within the first ``lead`` rows are those of the section before and not tested again.
    """
    window_rows = max(round(config.window_s / epoch_of(track)), 3)
    repair = partial(repair_slips, window_rows=window_rows)
    difference = scaled_difference(track, config.settle_s, repair, there)
    rows = max(round(config.window_s / difference.epoch_s), 3)
    parts = [
        _tests_in_piece(track, difference, number, piece, rows, lead, config)
        for number, piece in enumerate(difference.pieces)
        if piece.stop - piece.start >= rows
    ]
    columns = np.concatenate([np.empty((5, 0)), *parts], axis=1)
    trace_segment = np.full(track.time_s.size, -1)
    for number, piece in enumerate(difference.pieces):
        trace_segment[piece] = number
    return StatisticSeries(
        detector=NAME,
        system=_core.signal_spec(track.upper)["system"],
        prn=track.prn,
        unit="Hz",
        time_s=columns[0],
        value=columns[1],
        sigma=columns[2],
        sigma_thermal=columns[3],
        segment=columns[4].astype(np.int64),
        window_s=config.window_s,
        trace_time_s=track.time_s,
        trace=difference.cycles,
        trace_unit="cycles at the upper carrier",
        trace_segment=trace_segment,
        notes=_notes(track, difference, columns.shape[1], config),
    )


def thermal_sigma_hz(
    cn0_upper_hz: NDArray[np.float64],
    cn0_lower_hz: NDArray[np.float64],
    carrier_ratio: float,
    rows: int,
    epoch_s: float,
) -> NDArray[np.float64]:
    """Standard deviation of the slope from the thermal noise of both bands, in Hz."""
    phase = difference_sigma_hz(
        phase_sigma_cycles(cn0_upper_hz, epoch_s),
        phase_sigma_cycles(cn0_lower_hz, epoch_s),
        carrier_ratio,
    )
    return slope_sigma(phase, rows, epoch_s)


def published_sigma_hz(
    cn0_upper_hz: NDArray[np.float64],
    cn0_lower_hz: NDArray[np.float64],
    carrier_ratio: float,
    config: DetectionConfig,
) -> NDArray[np.float64]:
    """Standard deviation of the rate difference by the published loop model, in Hz."""
    settings = (
        config.published_integration_s,
        config.published_loop_bandwidth_hz,
        config.published_fll_factor,
    )
    return difference_sigma_hz(
        fll_sigma_hz(cn0_upper_hz, *settings), fll_sigma_hz(cn0_lower_hz, *settings), carrier_ratio
    )


def _tests_in_piece(
    track: ComboTrack,
    difference: Difference,
    number: int,
    piece: slice,
    rows: int,
    lead: int,
    config: DetectionConfig,
) -> NDArray[np.float64]:
    """Columns time, slope, sigma, thermal sigma, piece number of the supported windows."""
    upper = sliding_mean(ratio_hz(track.cn0_upper_dbhz[piece]), rows)
    lower = sliding_mean(ratio_hz(track.cn0_lower_dbhz[piece]), rows)
    slope = sliding_slope(difference.cycles[piece], rows, difference.epoch_s)
    end = track.time_s[piece][rows - 1 :] + difference.epoch_s / 2.0
    thermal = thermal_sigma_hz(upper, lower, difference.carrier_ratio, rows, difference.epoch_s)
    sigma = thermal
    if config.threshold_model == "published":
        # Never sharper than physics allows: short windows are noisier than the published loop.
        sigma = np.maximum(
            published_sigma_hz(upper, lower, difference.carrier_ratio, config), thermal
        )
    supported = np.minimum(upper, lower) >= 10.0 ** (config.min_cn0_dbhz / 10.0)
    supported &= np.arange(piece.start + rows - 1, piece.stop) >= lead
    table = np.vstack([end, slope, sigma, thermal, np.full(end.size, float(number))])
    return np.asarray(table[:, supported])


def _notes(
    track: ComboTrack, difference: Difference, tests: int, config: DetectionConfig
) -> tuple[str, ...]:
    notes = []
    if difference.slips:
        notes.append(f"{difference.slips} cycle slip(s) repaired")
    if len(difference.pieces) > 1:
        notes.append(f"tracking in {len(difference.pieces)} pieces")
    if tests == 0:
        longest = max((p.stop - p.start for p in difference.pieces), default=0)
        if longest * difference.epoch_s < config.window_s:
            notes.append(
                f"longest joint tracking after settling is {longest * difference.epoch_s:.2f} s, "
                f"one window is {config.window_s:g} s"
            )
        else:
            notes.append(
                f"C/N0 of {track.lower} or {track.upper} is under {config.min_cn0_dbhz:g} dB-Hz"
            )
    return tuple(notes)
