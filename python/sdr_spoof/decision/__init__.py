"""Decision rules: from a statistic to an alarm. One file and one line in :data:`RULES` each.

A rule is a pure function of a statistic series and the configuration; it returns the latched
decision, or None while the statistic gives no cause.
"""

from __future__ import annotations

from collections.abc import Callable

from sdr_spoof.decision import threshold
from sdr_spoof.decision.record import Decision
from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.series import StatisticSeries
from sdr_spoof.errors import ConfigError

__all__ = ["RULES", "Decision", "Rule", "find"]

Rule = Callable[[StatisticSeries, DetectionConfig], Decision | None]

RULES: dict[str, Rule] = {
    "threshold": threshold.decide,
}
"""Every rule, by name."""


def find(name: str) -> Rule:
    """The rule of that name; raises ConfigError that lists the known ones."""
    if name not in RULES:
        raise ConfigError(f"unknown decision rule '{name}'; known rules: {', '.join(RULES)}")
    return RULES[name]
