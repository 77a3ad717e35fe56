"""Decision rules: from a statistic to an alarm. One file and one line in :data:`RULES` each.

A rule is a :class:`.rule.SequentialRule`: a pure function from samples, in standard deviations, to
a statistic that grows with the evidence. :mod:`.calibration` sets its threshold. :func:`decide`
applies it to the series of a detector, whatever that is, and returns the latched decision, None
while the statistic gives no cause, or a :class:`.record.Refusal` where the rule cannot judge.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sdr_spoof.decision import (
    chi_square,
    cusum,
    cusum_parallel,
    glr_windows,
    improved_sprt,
    improved_sprt_as_printed,
    local_mean,
    sampled,
    sprt_classic,
    t_test,
    threshold,
    trained_threshold,
)
from sdr_spoof.decision.record import Decision, Refusal
from sdr_spoof.decision.rule import SequentialRule, first_alarm, latched
from sdr_spoof.errors import ConfigError

if TYPE_CHECKING:
    from sdr_spoof.detectors.config import DetectionConfig
    from sdr_spoof.detectors.series import StatisticSeries

__all__ = [
    "RULES",
    "Decision",
    "Refusal",
    "SequentialRule",
    "decide",
    "find",
    "first_alarm",
    "latched",
]

RULES: dict[str, SequentialRule[Any]] = {
    module.RULE.name: module.RULE
    for module in (
        threshold,
        trained_threshold,
        t_test,
        local_mean,
        chi_square,
        sprt_classic,
        improved_sprt,
        improved_sprt_as_printed,
        cusum,
        cusum_parallel,
        glr_windows,
    )
}
"""Every rule, by name."""


def find(name: str) -> SequentialRule[Any]:
    """The rule of that name; raises ConfigError that lists the known ones."""
    if name not in RULES:
        raise ConfigError(f"unknown decision rule '{name}'; known rules: {', '.join(RULES)}")
    return RULES[name]


def decide(series: StatisticSeries, config: DetectionConfig) -> Decision | Refusal | None:
    """What the configured rule says of a series."""
    rule = find(config.rule)
    if rule.decide is not None:
        return rule.decide(series, config)
    return sampled.decide(rule, series, config)
