"""Detectors that ask an INS: statistics of :class:`Measurements` and :class:`InertialStates`.

A detector is one file and one line in :data:`AIDED`; what it gives are the same series as those of
:mod:`sdr_spoof.detectors`, so that rules, decisions and reports work on them unchanged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof.aiding.rate_config import RateConfig
from sdr_spoof.errors import ConfigError

from . import (
    position_consistency,
    rate_consistency,
    rate_drag,
    rate_local,
    rate_satellites,
)

if TYPE_CHECKING:
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.config import Config
    from sdr_spoof.detectors.series import StatisticSeries

__all__ = ["AIDED", "AidedDetector", "RateConfig", "find"]


@dataclass(frozen=True)
class AidedDetector:
    """A registered detector."""

    name: str
    title: str
    tests: str
    """What is tested, in words for the report."""
    blind_to: str
    """What it cannot see, in words for the report."""
    statistics: Callable[[Measurements, InertialStates, Config], Iterator[StatisticSeries]]
    """Series after series; those of no single satellite have the system '' and PRN 0."""


AIDED: dict[str, AidedDetector] = {
    d.name: d
    for d in (
        AidedDetector(
            rate_drag.NAME,
            "Drag against INS",
            "whether the phases move the antenna in a way that no error of the INS explains",
            "a drag that grows as slowly as the INS may drift of itself; an attack that began "
            "before the first epoch; one that follows the true motion exactly; clock attacks",
            rate_drag.statistics,
        ),
        AidedDetector(
            rate_local.NAME,
            "Local rate consistency",
            "whether the rate by phase, against the INS, has changed within the last seconds",
            "a steady drag, after its beginning; slow onsets; clock attacks",
            rate_local.statistics,
        ),
        AidedDetector(
            rate_consistency.NAME,
            "Rate consistency",
            "whether the velocity by phase is that of the INS, as far as the INS is good",
            "drags that the drift of the INS hides: after minutes without alignment it judges "
            "nothing; a position step, but for the epoch in which it happens; clock attacks",
            rate_consistency.statistics,
        ),
        AidedDetector(
            rate_satellites.NAME,
            "Rate consistency of each satellite",
            "whether each satellite's phase moves as the INS and the other satellites say",
            "attacks that move all ranges alike; drags that noise or the drift of the INS hide",
            rate_satellites.statistics,
        ),
        AidedDetector(
            position_consistency.NAME,
            "Position consistency",
            "whether the fix by code is where the INS is, as far as the INS is good",
            "displacements that the drift of the INS hides, and all slow drags",
            position_consistency.statistics,
        ),
    )
}
"""Every detector, by name."""


def find(name: str) -> AidedDetector:
    """The detector of that name; raises ConfigError that lists the known ones."""
    if name not in AIDED:
        raise ConfigError(f"unknown detector '{name}'; known detectors: {', '.join(AIDED)}")
    return AIDED[name]
