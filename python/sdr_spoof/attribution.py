"""Which sideband of a satellite was captured: all evidence in one probability.

Each piece of evidence names a signal and is taken to be wrong with a stated probability, chosen on
the safe side. Pieces of different physics are taken as independent, so that odds multiply:

* carriers (wrong in 1 of 1000): the one that left its own course, after what the receiver's clock
  explains, as all other satellites show it, has been taken off (``detectors/band_attribution``);
* code against carrier of one signal alone (1 of 100): a test of consistency that names its signal;
* shape of one correlation peak alone (1 of 10): multipath does not choose the spoofed band;
* power of one signal alone (1 of 5).

That several signals were captured is one more hypothesis, ``BOTH`` times as likely beforehand.
Evidence of a kind that shows in several signals speaks for it, and evidence in one alone against it
as far as that kind would miss the other captured signal (``MISSED``: codes that follow their
carriers part from them in chance fashion, the others are seldom missed). Symmetry counts for one
signal only: all bands of a satellite share one code loop, which the captured one pulls.

A signal is named from ``attribution_confidence`` on; below it, the answer is "cannot tell", or
that both changed where that is the likeliest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sdr_spoof import detectors
from sdr_spoof.detectors import DetectionConfig, delta_metric, power, second_peak
from sdr_spoof.records import Alarm
from sdr_spoof.signals import signal_spec

WRONG = {"carriers": 1e-3, "code": 1e-2, "shape": 0.1, "power": 0.2}
"""Probability that a piece of evidence names the wrong signal."""
MISSED = {"carriers": 0.02, "code": 0.3, "shape": 0.1, "power": 0.1}
"""Probability that it shows in one signal only where several are captured."""
BOTH = 0.1
"""How likely it is beforehand that several were captured, against one of them."""
SHARED_LOOP = delta_metric.NAME
"""The test of what the common code loop moves in all bands."""


@dataclass(frozen=True)
class Attribution:
    """Which signal was captured, None where it cannot be told."""

    signal: str | None
    confidence: float | None
    """Probability of the likeliest signal, named or not; None without evidence."""
    evidence: tuple[str, ...] = ()
    """Kinds of evidence that there were, with the signal each names, in words."""
    both: bool = False
    """Whether it is likelier that several were captured than any one."""


def attribute(
    signals: Sequence[str], alarms: Sequence[Alarm], onset_s: float, config: DetectionConfig
) -> Attribution:
    """Weigh the alarms of one satellite, which was received on these signals.

    Alarms with an onset further than ``fusion_together_s`` from that of the attack are passed over.
    """
    if len(signals) == 1:
        return Attribution(signals[0], 1.0)
    near = [a for a in alarms if abs(a.onset_s - onset_s) <= config.fusion_together_s]
    named = {kind: bands for kind in WRONG if (bands := _named(kind, signals, near))}
    if not named:
        return Attribution(None, None)
    likelihood = {s: _alone(s, named) for s in signals}
    several = BOTH * float(np.prod([_several(kind, bands) for kind, bands in named.items()]))
    best = max(signals, key=lambda s: likelihood[s])
    confidence = likelihood[best] / (sum(likelihood.values()) + several)
    sure = confidence >= config.attribution_confidence
    words = tuple(
        f"{kind}: {' and '.join(signal_spec(s).composite for s in sorted(bands))}"
        for kind, bands in named.items()
    )
    return Attribution(best if sure else None, confidence, words, several > likelihood[best])


def _named(kind: str, signals: Sequence[str], alarms: Sequence[Alarm]) -> set[str]:
    """Signals that the evidence of a kind names."""
    of_kind = [
        a
        for a in alarms
        # What all satellites share, and a second peak, which is of two transmitters, do not say
        # which band was captured.
        if a.band in signals
        and kind_of(a) == kind
        and detectors.common_cause(a) is None
        and a.detector != second_peak.NAME
    ]
    own = {a.band for a in of_kind if a.detector != SHARED_LOOP}
    shared = {a.band for a in of_kind if a.detector == SHARED_LOOP}
    found = own or (shared if len(shared) == 1 else set())
    return {band for band in found if band is not None}


def _alone(signal: str, named: dict[str, set[str]]) -> float:
    """Likelihood of the evidence if this signal alone was captured."""
    right = (bands == {signal} for bands in named.values())
    return float(
        np.prod([1.0 - WRONG[k] if r else WRONG[k] for k, r in zip(named, right, strict=True)])
    )


def _several(kind: str, bands: set[str]) -> float:
    """Likelihood of one kind of evidence if several signals were captured."""
    return MISSED[kind] if len(bands) == 1 else 1.0 - MISSED[kind]


def kind_of(alarm: Alarm) -> str:
    """Kind of evidence that an alarm's band is; a key of :data:`WRONG`."""
    if alarm.detector == power.NAME:
        return "power"
    if detectors.find(alarm.detector).evidence == "quality":
        return "shape"
    return "code" if alarm.detector.startswith("code") else "carriers"
