"""From a scenario and a seed to a track log, at either level of fidelity.

Both start to track at the truth, with the small errors that a good acquisition leaves: a campaign
is about tracking and detection, and what a search misses would blur it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from sdr_spoof.acquisition import NOT_BY_DEFAULT
from sdr_spoof.correlator_level import simulate
from sdr_spoof.scenario import transmissions
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.signals import satellite_name
from sdr_spoof.studies.tracking import seeds as true_acquisitions
from sdr_spoof.tracking import track

from .points import Point

if TYPE_CHECKING:
    from sdr_spoof.records import Acquisition, TrackLog
    from sdr_spoof.scenario import Scenario

LevelFunction = Callable[[Point, int], "TrackLog"]


def simulate_if(point: Point, seed: int) -> TrackLog:
    """Make the samples and receive them; they are never written."""
    scenario = seeded(point.scenario, seed)
    recording = LiveRecording(scenario, threads=1)
    return track(recording, _starts(scenario), point.tracking, threads=1)


def simulate_correlators(point: Point, seed: int) -> TrackLog:
    """Make the correlators' outputs directly; a second takes a fraction of a millisecond."""
    return simulate(point.scenario, point.tracking, seed=seed, threads=1)


LEVELS: dict[str, LevelFunction] = {
    "correlator": simulate_correlators,
    "if": simulate_if,
}
"""Every level, by name."""


def seeded(scenario: Scenario, seed: int) -> Scenario:
    """The scenario with another seed of its noise and its random choices."""
    recording = scenario.recording.model_copy(update={"seed": seed})
    return scenario.model_copy(update={"recording": recording})


def subjects(scenario: Scenario) -> dict[str, list[str]]:
    """Satellites that somebody transmits, and the signals of each that are tracked."""
    found: dict[str, list[str]] = {}
    for t in transmissions(scenario):
        signals = found.setdefault(satellite_name(t.system, t.prn), [])
        if t.signal not in (*NOT_BY_DEFAULT, *signals):
            signals.append(t.signal)
    return found


def _starts(scenario: Scenario) -> list[Acquisition]:
    """One for each signal, the authentic one where there are several."""
    first: dict[tuple[str, int], Acquisition] = {}
    for a in true_acquisitions(scenario):
        if a.signal not in NOT_BY_DEFAULT:
            first.setdefault((a.signal, a.prn), a)
    return list(first.values())
