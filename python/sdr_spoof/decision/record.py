"""What a rule decides."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Decision:
    """A latched alarm on one statistic series."""

    alarm_s: float
    """Time of the test that fired; the alarm stays from then on."""
    onset_s: float
    """Maximum-likelihood start of the disturbance."""
    statistic: float
    """Most significant value within one window from the alarm."""
    threshold: float
    """Threshold at that value."""
    log10_p: float
    """log10 of the H0 probability of that value in one test, clipped."""
    unit: str | None = None
    """Of statistic and threshold; None for that of the series."""


@dataclass(frozen=True)
class Refusal:
    """A rule cannot judge a series: its samples are not what the rule was calibrated for."""

    reason: str
    """In words, for the notes of the satellite."""
