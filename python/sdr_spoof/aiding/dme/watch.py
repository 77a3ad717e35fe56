"""The course of a rule's statistic in every channel, for pictures and tables."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sdr_spoof import decision
from sdr_spoof.decision.calibration import threshold_for
from sdr_spoof.decision.sampled import baseline_of, independent
from sdr_spoof.decision.whitening import fit, whiten
from sdr_spoof.detectors.config import DetectionConfig

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .config import SequentialConfig
    from .judge import Judgement


@dataclass(frozen=True)
class Watched:
    """One channel."""

    test: str
    channel: str
    time_s: NDArray[np.float64]
    """(K,)"""
    z: NDArray[np.float64]
    """Samples in standard deviations, (K,)."""
    path: NDArray[np.float64]
    """The rule's statistic, (K,)."""
    threshold: float


def watch(judgement: Judgement, config: SequentialConfig) -> tuple[Watched, ...]:
    """Of all channels that were judged."""
    each = config.false_alarms_per_hour / max(len(judgement.tested), 1)
    rule = decision.find(config.rule)
    rule = replace(rule, parameters=rule.configured(rule.parameters, DetectionConfig()))
    found = []
    for tested in judgement.tested:
        if tested.note:
            continue
        samples = independent(tested.series, each)
        rho = fit(samples.z[: baseline_of(samples.z.size)]).rho
        path = rule.run(whiten(samples.z, rho))
        threshold = threshold_for(rule, each, rate_hz=1.0 / samples.spacing_s)
        time_s = tested.series.time_s[samples.row]
        found.append(Watched(tested.test, tested.channel, time_s, samples.z, path, threshold))
    return tuple(found)
