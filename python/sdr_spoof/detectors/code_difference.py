"""Difference of the code delays of the two sidebands of one satellite.

Physics: both codes travel one path, so the delay of the upper band minus that of the lower is a
constant of satellite and receiver; the ionosphere moves it by 3 mm per TECU (40.3e16 (1 / f_u^2 -
1 / f_l^2) m). A spoofer that drags the code of one band moves it at the drag's speed, whether its
carrier follows the code or is locked to the satellite's frequency.

Statistic and law: the generalised likelihood ratio of :mod:`.jump_slope` on means of blocks
(:mod:`.code_blocks`), with level and noise measured over the reference before each window, and a
threshold for a rate of false alarms per hour and satellite (:mod:`.alarm_rate`). Which of the bands
moved is for code minus carrier to say.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.detectors import code_blocks, jump_slope
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.phase_difference import epoch_of, settled
from sdr_spoof.detectors.presence import combo_sections
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.records import ComboTrack, State, TrackLog
from sdr_spoof.signals import LIGHT_M_S

NAME = "code_difference"


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The statistic of every satellite that is tracked in both bands, section by section."""
    lead_s = code_blocks.lead_s(
        config.code_difference_windows_s, config.code_difference_reference_s, config
    )
    for part, there, lead, first in combo_sections(log, config, lead_s):
        yield statistic(part, config, there, lead, first)


def statistic(
    track: ComboTrack,
    config: DetectionConfig,
    there: NDArray[np.bool_] | None = None,
    lead: int = 0,
    first: int = 0,
) -> StatisticSeries:
    """The tests on a track or a section of it, arguments as in :mod:`.phase_difference_glr`."""
    epoch_s = epoch_of(track)
    metres = LIGHT_M_S * track.code_difference_s
    usable = (
        (track.state >= State.SYNCED) & np.isfinite(metres) & (True if there is None else there)
    )
    both = (track.cn0_lower_dbhz, track.cn0_upper_dbhz)
    rows = code_blocks.blocks(
        track.time_s,
        metres,
        # The noisier band is not known: whichever lost more.
        np.maximum(*(code_blocks.code_variance(cn0, epoch_s) for cn0 in both)),
        np.minimum(*both) >= config.min_cn0_dbhz,
        settled(track.time_s, usable, code_blocks.settle_rows(epoch_s, config)),
        epoch_s,
        first,
    )
    plan = code_blocks.plan_for(
        epoch_s,
        config.code_difference_windows_s,
        config.code_difference_reference_s,
        config.code_difference_drift_m_s,
        config,
    )
    return jump_slope.series(
        rows,
        plan,
        code_blocks.lead_blocks(lead, epoch_s, first),
        config.false_alarms_per_hour,
        detector=NAME,
        system=_core.signal_spec(track.upper)["system"],
        prn=track.prn,
        trace_unit="code delay, upper minus lower band, m",
        notes=code_blocks.notes(rows, plan),
    )
