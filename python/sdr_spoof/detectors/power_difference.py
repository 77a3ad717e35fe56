"""Power of one band of a satellite over that of its other band.

Physics: both bands leave one satellite and take one path, so the ratio of their powers stands
still; shadowing, attitude and a receiver's gain move both. A second signal in one band moves the
ratio unless it stands at right angles to the satellite's, when it turns the phase most: together
with the phase difference this finds a weak spoofer of any phase. At 10 dB below the satellite it
is +2.4 dB in phase and -3.3 dB in antiphase. An echo does the same, since it reaches the bands with
other phases: an alarm is a suspicion.

Statistic and law: 10 log10 of the ratio of the prompts' powers, noise taken out, over blocks
(:mod:`.code_blocks`), tested by the generalised likelihood ratio of :mod:`.jump_slope` with level
and noise measured over the reference before each window, and a threshold for a rate of false alarms
per hour and satellite (:mod:`.alarm_rate`). A block of N epochs has the relative variance
(2 / s + 1 / s^2) / N in each band, s = C/N0 T (non-central chi-square with 2 degrees of freedom).
``power_difference_wander_db`` is the band in which the ratio may innocently go to and fro: 1 dB is
what echoes of a twentieth of the amplitude do.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.detectors import code_blocks, jump_slope
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.jump_slope import Plan
from sdr_spoof.detectors.phase_difference import epoch_of, ratio_hz, settled
from sdr_spoof.detectors.presence import combo_sections, rows_in
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.records import ComboTrack, State, TrackLog
from sdr_spoof.signals import signal_spec

NAME = "power_difference"
DB = 10.0 / np.log(10.0)
FLOOR = 0.1
"""Least power of a block, in units of the noise's share of it."""


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The statistic of every satellite that is tracked in both bands, section by section."""
    lead_s = code_blocks.lead_s(
        config.power_difference_windows_s, config.power_difference_reference_s, config
    )
    for part, there, lead, first in combo_sections(log, config, lead_s):
        powers = [_power(log, part, signal) for signal in (part.upper, part.lower)]
        if powers[0] is not None and powers[1] is not None:
            yield statistic(part, (powers[0], powers[1]), config, there, lead, first)


def _power(log: TrackLog, combo: ComboTrack, signal: str) -> NDArray[np.float64] | None:
    """|P|^2 of each row over its noise, and the noise: shape (2, M); None for another track."""
    found = rows_in(log, combo, signal)
    if found is None:
        return None
    track, rows = found
    samples = log.sample_rate_hz * track.integration_s
    prompt = np.abs(track.taps[:, track.prompt_tap].astype(np.complex128) / samples) ** 2
    return np.asarray(np.vstack([prompt, track.noise_power / samples])[:, rows])


def statistic(
    track: ComboTrack,
    powers: tuple[NDArray[np.float64], NDArray[np.float64]],
    config: DetectionConfig,
    there: NDArray[np.bool_],
    lead: int = 0,
    first: int = 0,
) -> StatisticSeries:
    """The tests on a track or a section of it.

    ``powers`` are those of the upper and the lower band with the noise's share, each shape (2, M);
    the other arguments as in :mod:`.phase_difference_glr`.
    """
    epoch_s = epoch_of(track)
    usable = (track.state >= State.SYNCED) & there & (powers[0][1] > 0.0) & (powers[1][1] > 0.0)
    pieces = settled(track.time_s, usable, code_blocks.settle_rows(epoch_s, config))
    cn0 = [ratio_hz(c) * epoch_s for c in (track.cn0_upper_dbhz, track.cn0_lower_dbhz)]
    spread = sum((2.0 / s + 1.0 / s**2 for s in cn0), np.zeros(track.epochs))
    strong = np.minimum(track.cn0_upper_dbhz, track.cn0_lower_dbhz) >= config.min_cn0_dbhz
    # Signal and noise of each band, in blocks.
    parts = [
        code_blocks.blocks(track.time_s, values, spread, strong, pieces, epoch_s, first)
        for values in (*powers[0], *powers[1])
    ]
    upper, lower = (
        DB * np.log(np.maximum(p.values - n.values, FLOOR * n.values))
        for p, n in (parts[:2], parts[2:])
    )
    return jump_slope.series(
        replace(parts[0], values=upper - lower),
        plan_for(epoch_s, config),
        code_blocks.lead_blocks(lead, epoch_s, first),
        config.false_alarms_per_hour,
        detector=NAME,
        system=signal_spec(track.upper).system,
        prn=track.prn,
        trace_unit="power, upper over lower band, dB",
        notes=code_blocks.notes(parts[0], plan_for(epoch_s, config)),
    )


def plan_for(epoch_s: float, config: DetectionConfig) -> Plan:
    """Windows, reference and groups in blocks."""
    return Plan.of(
        code_blocks.epochs_per_block(epoch_s) * epoch_s,
        config.power_difference_windows_s,
        (code_blocks.LEAST_REFERENCE_S, config.power_difference_reference_s),
        code_blocks.GROUP_S,
        config.power_difference_drift_db_s,
        config.power_difference_wander_db,
    )
