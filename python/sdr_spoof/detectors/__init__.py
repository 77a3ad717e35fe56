"""Detectors: statistics, each a number from physics with a known law under H0.

A detector is one file and one line in :data:`DETECTORS`; whether a statistic means an alarm is
for the rules of :mod:`sdr_spoof.decision` to say.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from sdr_spoof.detectors import (
    code_difference,
    code_minus_carrier,
    delta_metric,
    noise_floor,
    phase_difference_glr,
    phase_difference_rate,
    power,
    power_difference,
    ratio_metric,
    second_peak,
)
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.errors import ConfigError
from sdr_spoof.records import Alarm, TrackLog

__all__ = ["DETECTORS", "DetectionConfig", "Detector", "StatisticSeries", "common_cause", "find"]


@dataclass(frozen=True)
class Detector:
    """A registered detector."""

    name: str
    title: str
    tests: str
    """What is tested, in words for the report."""
    blind_to: str
    """What it cannot see, in words for the report."""
    statistics: Callable[[TrackLog, DetectionConfig], Iterator[StatisticSeries]]
    """Series after series, so that no more than one need be in memory."""
    evidence: Literal["consistency", "quality"] = "consistency"
    """Of 'consistency' between what must move together: an alarm means spoofing. Of signal
    'quality', which multipath and interference change too: an alarm is a suspicion."""
    common: Mapping[str, str] = field(default_factory=dict)
    """Quantities that are one of all satellites of a band, and what may be behind a rise, in words:
    they say nothing of which band of a satellite was captured."""


DETECTORS: dict[str, Detector] = {
    d.name: d
    for d in (
        Detector(
            phase_difference_rate.NAME,
            "Carrier phase difference rate",
            "whether the carriers of the satellite's two bands still move together",
            "a drag that moves the code but not the carrier; an attack on both bands that keeps "
            "their carriers coherent; a capture that was complete before the recording began, or "
            "during a loss of lock; a spoofer whose carrier is several Hz off from the start, "
            "which beats until lock is lost; drags slower than the threshold; satellites received "
            "in one band only",
            phase_difference_rate.statistics,
        ),
        Detector(
            phase_difference_glr.NAME,
            "Jump and slope of the carrier phase difference",
            "whether the carriers of the satellite's two bands stay where they were, and together",
            "a drag that moves the code but not the carrier; an attack on both bands that keeps "
            "their carriers coherent; a capture that was complete before the recording began, or "
            "during a loss of lock or the seconds after it; satellites received in one band only",
            phase_difference_glr.statistics,
        ),
        Detector(
            code_difference.NAME,
            "Code delay difference",
            "whether the codes of the satellite's two bands keep their distance",
            "an attack that moves the codes of both bands alike; a capture that was complete "
            "before the recording began, or during a loss of lock or the seconds after it; "
            "satellites received in one band only",
            code_difference.statistics,
        ),
        Detector(
            code_minus_carrier.NAME,
            "Code minus carrier",
            "whether the code of each signal moves with its own carrier",
            "a drag whose carrier follows its code; a capture that was complete before the "
            "recording began, or during a loss of lock or the seconds after it",
            code_minus_carrier.statistics,
        ),
        *(
            Detector(
                name,
                f"{what_of}{metric} metric".capitalize(),
                f"whether the {what} of each correlation peak {verb}",
                "a spoofer that is far stronger than the satellite, or far from its peak; changes "
                "slower than its reference; it cannot tell multipath from a spoofer",
                statistics,
                "quality",
            )
            for metric, what, module in (
                ("delta", "symmetry", delta_metric),
                ("ratio", "flatness", ratio_metric),
            )
            for name, what_of, verb, statistics in (
                (module.NAME, "", "has changed", module.mean),
                (module.SCATTER, "moving variance of the ", "has become restless", module.scatter),
            )
        ),
        Detector(
            power.NAME,
            "Power",
            "whether power has risen beyond what its past explains: C/N0, the band's noise, or the "
            "one against the other; and the noise of all satellites of a band together",
            "a spoofer as strong as the satellite; one that raises its power slowly; it cannot "
            "tell interference, multipath or a change of gain from a spoofer",
            power.statistics,
            "quality",
            {noise_floor.QUANTITY: noise_floor.CAUSE},
        ),
        Detector(
            power_difference.NAME,
            "Power difference",
            "whether the power of the satellite's two bands changes alike",
            "an attack that changes the power of both bands alike; changes slower than its "
            "reference; it cannot tell multipath from a spoofer; satellites received in one band "
            "only",
            power_difference.statistics,
            "quality",
        ),
        Detector(
            second_peak.NAME,
            "Second peak",
            "whether a search finds a second signal of the satellite, well away from the tracked "
            "one",
            "a second signal within ten chips of the tracked one, or below the search's threshold; "
            "one that is on the air between two searches only; one on a signal that is not "
            "searched (B1C, where B1I is tracked); which of both signals is the true one",
            second_peak.statistics,
        ),
    )
}
"""Every detector, by name."""


def find(name: str) -> Detector:
    """The detector of that name; raises ConfigError that lists the known ones."""
    if name not in DETECTORS:
        known = ", ".join(DETECTORS)
        raise ConfigError(f"unknown detector '{name}'; known detectors: {known}")
    return DETECTORS[name]


def common_cause(of: Alarm | StatisticSeries) -> str | None:
    """What may be behind a quantity that all satellites of a band share; None for any other."""
    return find(of.detector).common.get(of.quantity)
