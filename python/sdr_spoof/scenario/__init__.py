"""Scenarios: who transmits what and when, attacks among them; recordings made from them.

For files only: nothing here drives a transmitter.
"""

from .emitters import Transmission, transmissions
from .load import builtin_scenario, load_scenario
from .model import InducedAttack, RecordingPlan, Satellite, Scenario
from .synthesis import open_synthesizer, synthesize, truth_path
from .truth import truth

__all__ = [
    "InducedAttack",
    "RecordingPlan",
    "Satellite",
    "Scenario",
    "Transmission",
    "builtin_scenario",
    "load_scenario",
    "open_synthesizer",
    "synthesize",
    "transmissions",
    "truth",
    "truth_path",
]
