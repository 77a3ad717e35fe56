"""Jump and slope of the carrier-scaled phase difference, over several windows at once.

Physics: phi_u - (f_u / f_l) phi_l stands still whatever the satellite, the user and the receiver
clock do (:mod:`.phase_difference`). A second signal in one band moves it at once by the angle that
it adds to the phasor, and turns it while it is dragged.

Statistic and law: the generalised likelihood ratio of :mod:`.jump_slope`, with level and noise
measured over the ``reference`` before each window, and a threshold for a rate of false alarms per
hour and satellite (:mod:`.alarm_rate`). The measured phase is oscillator plus discriminator, so its
noise is white from epoch to epoch. A steady offset (inter-band bias, multipath that stays) is in
the reference; the ionosphere moves the difference by 0.016 cycle per TECU and is covered by the
drift that is allowed.

Every slip of a whole multiple of a loop's quantum is taken out first: measured phases are known up
to such multiples only, whoever made them jump.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.detectors import jump_slope
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.jump_slope import Plan, Rows
from sdr_spoof.detectors.phase_difference import (
    Difference,
    epoch_of,
    phase_sigma_cycles,
    ratio_hz,
    scaled_difference,
)
from sdr_spoof.detectors.presence import combo_sections
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.detectors.slips import repair_every_slip
from sdr_spoof.records import ComboTrack, TrackLog

NAME = "phase_difference_glr"
LEAST_REFERENCE_S = 2.0
"""Reference without which nothing is tested."""
PHASE_KURTOSIS = 8.0 * (2.0 * np.pi) ** 2
"""Excess kurtosis of one band's phase, by its variance in cycles^2: 4 / (C/N0 T), measured at 30 to
35 dB-Hz. An arctangent's tails are heavier where the noise has shortened the phasor."""
GROUP_S = 0.1
"""Signal in which the noise is measured about a line of its own."""


def statistics(log: TrackLog, config: DetectionConfig) -> Iterator[StatisticSeries]:
    """The statistic of every satellite that is tracked in both bands, section by section."""
    reach_s = config.phase_difference_glr_reference_s + max(config.phase_difference_glr_windows_s)
    lead_s = config.settle_s + reach_s + GROUP_S
    for part, there, lead, first in combo_sections(log, config, lead_s):
        yield statistic(part, config, there, lead, first)


def plan_for(epoch_s: float, config: DetectionConfig) -> Plan:
    """Windows, reference and groups in epochs."""
    return Plan.of(
        epoch_s,
        config.phase_difference_glr_windows_s,
        (LEAST_REFERENCE_S, config.phase_difference_glr_reference_s),
        GROUP_S,
        config.phase_difference_glr_drift_hz,
    )


def statistic(
    track: ComboTrack,
    config: DetectionConfig,
    there: NDArray[np.bool_] | None = None,
    lead: int = 0,
    first: int = 0,
) -> StatisticSeries:
    """The tests on a track or on a section of it.

    Rows that are not ``there``, shape (M,), had no signal and are left out. Windows that end
    within the first ``lead`` rows are those of the section before and not tested again; ``first``
    is the number of the section's first row in the whole track.
    """
    difference = scaled_difference(track, config.settle_s, repair_every_slip, there)
    plan = plan_for(epoch_of(track), config)
    return jump_slope.series(
        _rows(track, difference, config, first),
        plan,
        lead,
        config.false_alarms_per_hour,
        detector=NAME,
        system=_core.signal_spec(track.upper)["system"],
        prn=track.prn,
        trace_unit="scaled phase difference, cycles at the upper carrier",
        notes=_notes(difference, plan),
    )


def _rows(track: ComboTrack, difference: Difference, config: DetectionConfig, first: int) -> Rows:
    upper, lower = ratio_hz(track.cn0_upper_dbhz), ratio_hz(track.cn0_lower_dbhz)
    of_upper, of_lower = (phase_sigma_cycles(c, difference.epoch_s) ** 2 for c in (upper, lower))
    of_lower = difference.carrier_ratio**2 * of_lower
    spread = of_upper + of_lower
    return Rows(
        end_s=track.time_s + difference.epoch_s / 2.0,
        middle_s=track.time_s,
        values=difference.cycles,
        spread=spread,
        strong=np.minimum(upper, lower) >= 10.0 ** (config.min_cn0_dbhz / 10.0),
        pieces=difference.pieces,
        first=first,
        kurtosis=PHASE_KURTOSIS * (of_upper**3 + of_lower**3) / spread**2,
    )


def _notes(difference: Difference, plan: Plan) -> tuple[str, ...]:
    notes = []
    if difference.slips:
        notes.append(f"{difference.slips} cycle slip(s) repaired")
    if len(difference.pieces) > 1:
        notes.append(f"tracking in {len(difference.pieces)} pieces")
    longest = max((p.stop - p.start for p in difference.pieces), default=0)
    if longest < plan.shortest:
        notes.append(
            f"longest joint tracking after settling is {longest * plan.step_s:.2f} s, "
            f"{plan.shortest * plan.step_s:.2f} s are needed"
        )
    return tuple(notes)
