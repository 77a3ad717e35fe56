"""Scenarios: who transmits what and when, attacks among them; recordings made from them.

For files only: nothing here drives a transmitter.
"""

from .attack import Asynchronous, InducedAttack, Meaconing, Multipath, Position, Ray
from .dme_table import DmeTable, dme_of
from .emitters import Transmission, transmissions
from .imu_data import ScenarioImu, imu_of
from .imu_table import ImuTable
from .load import builtin_scenario, find_scenario, load_scenario, scenario_names
from .model import Scenario
from .recording_plan import RecordingPlan
from .satellite import Satellite
from .sky import Sky, SkySatellite, SkyTable
from .synthesis import dme_path, imu_path, open_synthesizer, synthesize, truth_path
from .truth import attack_timelines, truth

__all__ = [
    "Asynchronous",
    "DmeTable",
    "ImuTable",
    "InducedAttack",
    "Meaconing",
    "Multipath",
    "Position",
    "Ray",
    "RecordingPlan",
    "Satellite",
    "Scenario",
    "ScenarioImu",
    "Sky",
    "SkySatellite",
    "SkyTable",
    "Transmission",
    "attack_timelines",
    "builtin_scenario",
    "dme_of",
    "dme_path",
    "find_scenario",
    "imu_of",
    "imu_path",
    "load_scenario",
    "open_synthesizer",
    "scenario_names",
    "synthesize",
    "transmissions",
    "truth",
    "truth_path",
]
