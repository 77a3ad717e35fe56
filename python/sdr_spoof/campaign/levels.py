"""From a scenario and a seed to a track log, at either level of fidelity.

Both start to track at the truth, with the small errors that a good acquisition leaves: a campaign
is about tracking and detection, and what a search misses would blur it.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING

from sdr_spoof.acquisition import NOT_BY_DEFAULT
from sdr_spoof.errors import ConfigError
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.signals import components
from sdr_spoof.studies.tracking import seeds as true_acquisitions
from sdr_spoof.tracking import track

from .points import Point

if TYPE_CHECKING:
    from sdr_spoof.records import Acquisition, TrackLog
    from sdr_spoof.scenario import Satellite, Scenario

LevelFunction = Callable[[Point, int], "TrackLog"]


def simulate_if(point: Point, seed: int) -> TrackLog:
    """Make the samples and receive them; they are never written."""
    scenario = seeded(point.scenario, seed)
    recording = LiveRecording(scenario, threads=1)
    return track(recording, _starts(scenario), point.tracking, threads=1)


def simulate_correlators(point: Point, seed: int) -> TrackLog:
    """Correlator-level simulation."""
    try:
        correlator_level = import_module("sdr_spoof.correlator_level")
    except ImportError as error:
        raise ConfigError("level 'correlator' is not available; use level = \"if\"") from error
    log: TrackLog = correlator_level.simulate(point.scenario, point.tracking, seed=seed, threads=1)
    return log


LEVELS: dict[str, LevelFunction] = {
    "correlator": simulate_correlators,
    "if": simulate_if,
}
"""Every level, by name."""


def seeded(scenario: Scenario, seed: int) -> Scenario:
    """The scenario with another seed of its noise and its random choices."""
    recording = scenario.recording.model_copy(update={"seed": seed})
    return scenario.model_copy(update={"recording": recording})


def tracked_signals(satellite: Satellite) -> list[str]:
    """Components of a satellite's signals that are tracked."""
    sent = [c for signal in satellite.signals for c in components(signal)]
    return [c for c in sent if c not in NOT_BY_DEFAULT]


def _starts(scenario: Scenario) -> list[Acquisition]:
    """One for each authentic component, those of spoofers left out."""
    wanted = {(c, s.prn) for s in scenario.satellite for c in tracked_signals(s)}
    first = {(a.signal, a.prn): a for a in reversed(true_acquisitions(scenario))}
    return [a for key, a in sorted(first.items()) if key in wanted]
