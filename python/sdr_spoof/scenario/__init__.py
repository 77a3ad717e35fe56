"""Scenarios: who transmits what and when, attacks among them; recordings made from them.

For files only: nothing here drives a transmitter.
"""

from .attack import Asynchronous, InducedAttack, Meaconing, Multipath, Position, Ray
from .emitters import Transmission, transmissions
from .load import builtin_scenario, find_scenario, load_scenario, scenario_names
from .model import Scenario
from .recording_plan import RecordingPlan
from .satellite import Satellite
from .sky import Sky, SkySatellite, SkyTable
from .synthesis import open_synthesizer, synthesize, truth_path
from .truth import attack_timelines, truth

__all__ = [
    "Asynchronous",
    "InducedAttack",
    "Meaconing",
    "Multipath",
    "Position",
    "Ray",
    "RecordingPlan",
    "Satellite",
    "Scenario",
    "Sky",
    "SkySatellite",
    "SkyTable",
    "Transmission",
    "attack_timelines",
    "builtin_scenario",
    "find_scenario",
    "load_scenario",
    "open_synthesizer",
    "scenario_names",
    "synthesize",
    "transmissions",
    "truth",
    "truth_path",
]
