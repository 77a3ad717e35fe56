"""Which sideband of a satellite was captured: all evidence in one probability.

Each piece of evidence names a signal and is taken to be wrong with a stated probability, chosen on
the safe side. Pieces of different physics are taken as independent, so that odds multiply:

* carriers (wrong in 1 of 1000): the one that left its own course, after what the receiver's clock
  explains, as all other satellites show it, has been taken off (``detectors/band_attribution``);
* code against carrier of one signal alone (1 of 100): a test of consistency that names its signal;
* shape of one correlation peak alone (1 of 10): multipath does not choose the spoofed band;
* power of one signal alone (1 of 5).

What shows in both bands says nothing about which. A signal is named from ``attribution_confidence``
on; below it, the answer is "cannot tell".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sdr_spoof import detectors
from sdr_spoof.detectors import DetectionConfig, noise_floor, power, second_peak
from sdr_spoof.records import Alarm
from sdr_spoof.signals import signal_spec

WRONG = {"carriers": 1e-3, "code": 1e-2, "shape": 0.1, "power": 0.2}
"""Probability that a piece of evidence names the wrong signal."""


@dataclass(frozen=True)
class Attribution:
    """Which signal was captured, None where it cannot be told."""

    signal: str | None
    confidence: float | None
    """Probability of the likeliest signal, named or not; None without evidence."""
    evidence: tuple[str, ...]
    """Kinds of evidence that there were, with the signal each names, in words."""


def attribute(
    signals: Sequence[str], alarms: Sequence[Alarm], onset_s: float, config: DetectionConfig
) -> Attribution:
    """Weigh the alarms of one satellite, which was received on these signals.

    Alarms with an onset further than ``fusion_together_s`` from that of the attack are passed over.
    """
    if len(signals) == 1:
        return Attribution(signals[0], 1.0, ())
    named: dict[str, set[str]] = {kind: set() for kind in WRONG}
    for alarm in alarms:
        if alarm.band is None or alarm.band not in signals:
            continue
        # Of all satellites, and of two transmitters: neither says which band was captured.
        if alarm.quantity == noise_floor.QUANTITY or alarm.detector == second_peak.NAME:
            continue
        if abs(alarm.onset_s - onset_s) <= config.fusion_together_s:
            named[kind_of(alarm)].add(alarm.band)
    found = {kind: next(iter(bands)) for kind, bands in named.items() if len(bands) == 1}
    if not found:
        return Attribution(None, None, ())
    odds = {signal: 0.0 for signal in signals}
    for kind, signal in found.items():
        odds[signal] += float(np.log((1.0 - WRONG[kind]) / WRONG[kind]))
    best = max(signals, key=lambda s: odds[s])
    # Each piece of evidence speaks for its signal and against all others alike.
    likelihood = {s: float(np.exp(odds[s] - odds[best])) for s in signals}
    confidence = likelihood[best] / sum(likelihood.values())
    sure = confidence >= config.attribution_confidence
    words = tuple(f"{kind}: {signal_spec(signal).composite}" for kind, signal in found.items())
    return Attribution(best if sure else None, confidence, words)


def kind_of(alarm: Alarm) -> str:
    """Kind of evidence that an alarm's band is; a key of :data:`WRONG`."""
    if alarm.detector == power.NAME:
        return "power"
    if detectors.find(alarm.detector).evidence == "quality":
        return "shape"
    return "code" if alarm.detector.startswith("code") else "carriers"
