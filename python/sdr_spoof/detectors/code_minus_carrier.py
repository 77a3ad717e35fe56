"""Code range minus carrier range of one signal.

Physics: code and carrier of a signal travel one path, and both count the receiver's clock, so the
ranges that they measure differ by a constant (the ambiguity) and by twice the ionosphere's course
(0.33 m per TECU at 1.57 GHz). A spoofer that drags its code and keeps its carrier at the
satellite's frequency moves the difference at the drag's speed. Each signal is judged by itself, so
the band is named, and satellites that are received in one band only are tested too.

Statistic and law: the generalised likelihood ratio of :mod:`.jump_slope` on means of blocks
(:mod:`.code_blocks`), with level and noise measured over the reference before each window, and a
threshold for a rate of false alarms per hour and satellite (:mod:`.alarm_rate`), which the signals
of a satellite share. Multipath that stays is a constant; weak multipath that moves is allowed for
(``code_wander_m``); strong one is seen as what it is, a code that leaves its carrier.

Cycle slips of the carrier are repaired where they can be told; one that cannot is 0.2 m at most.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.detectors import code_blocks, jump_slope
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.phase_difference import (
    epoch_of,
    phase_sigma_cycles,
    ratio_hz,
    settled,
    slip_quantum,
)
from sdr_spoof.detectors.presence import BELOW_DB, empty
from sdr_spoof.detectors.series import StatisticSeries, signals_of
from sdr_spoof.detectors.slips import repair_every_slip
from sdr_spoof.detectors.windows import sections
from sdr_spoof.records import SignalTrack, State, TrackLog
from sdr_spoof.signals import LIGHT_M_S

NAME = "code_minus_carrier"


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The statistic of every signal of every satellite, section by section."""
    lead_s = code_blocks.lead_s(
        config.code_minus_carrier_windows_s, config.code_minus_carrier_reference_s, config
    )
    for track in log.signals:
        share = 1.0 / signals_of(log, track)
        for first, stop, lead in sections(track, lead_s):
            yield statistic(track.part(first, stop), config, lead, first, share)


def statistic(
    track: SignalTrack,
    config: DetectionConfig,
    lead: int = 0,
    first: int = 0,
    share: float = 1.0,
) -> StatisticSeries:
    """The tests on a signal's track or a section of it.

    ``share`` is the part of the satellite's false alarms that the signal may make; the rest as in
    :mod:`.phase_difference_glr`.
    """
    epoch_s = epoch_of(track)
    usable = (
        (track.state >= State.SYNCED)
        & np.isfinite(track.code_phase_chips + track.carrier_phase_cycles)
        & ~empty(track, config.min_cn0_dbhz - BELOW_DB)
    )
    pieces = settled(track.time_s, usable, code_blocks.settle_rows(epoch_s, config))
    rows = code_blocks.blocks(
        track.time_s,
        difference_m(track, pieces),
        code_blocks.code_variance(track.cn0_dbhz, epoch_s),
        track.cn0_dbhz >= config.min_cn0_dbhz,
        pieces,
        epoch_s,
        first,
    )
    plan = code_blocks.plan_for(
        epoch_s,
        config.code_minus_carrier_windows_s,
        config.code_minus_carrier_reference_s,
        config.code_minus_carrier_drift_m_s,
        config,
    )
    return jump_slope.series(
        rows,
        plan,
        code_blocks.lead_blocks(lead, epoch_s, first),
        config.false_alarms_per_hour * share,
        detector=NAME,
        system=_core.signal_spec(track.signal)["system"],
        prn=track.prn,
        trace_unit="code minus carrier, m",
        notes=code_blocks.notes(rows, plan),
        signal=track.signal,
    )


def difference_m(track: SignalTrack, pieces: tuple[slice, ...]) -> NDArray[np.float64]:
    """Code range minus carrier range by piece, each up to a constant, in m; NaN elsewhere."""
    spec = _core.signal_spec(track.signal)
    epoch_s = epoch_of(track)
    quantum = slip_quantum(track.signal, track.prn)
    delay_s = track.time_s - track.code_phase_chips / spec["chip_rate_hz"]
    metres = np.full(track.time_s.size, np.nan)
    for piece in pieces:
        cn0_hz = float(np.mean(ratio_hz(track.cn0_dbhz[piece])))
        sigma = float(phase_sigma_cycles(cn0_hz, epoch_s))
        phase, _ = repair_every_slip(track.carrier_phase_cycles[piece], quantum, sigma)
        course = (delay_s[piece] - delay_s[piece][0]) - (phase - phase[0]) / spec["carrier_hz"]
        metres[piece] = LIGHT_M_S * course
    return metres
