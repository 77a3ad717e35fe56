"""Echoes through the whole receiver: largest score of each detector in one run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof import detectors
from sdr_spoof.correlator_level import simulate
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.scenario import Scenario
from sdr_spoof.signals import signal_spec

from . import published
from .multipath import DELAYS_M
from .receiver import BANDS, CORRELATOR_RATE_HZ, PRN

if TYPE_CHECKING:
    from sdr_spoof.records import TrackLog

CN0_DBHZ = 45.0
START_S, END_S = 20.0, 40.0
"""When the spoofer or an arriving echo comes: detectors that compare with the past have one."""
DRAG_HZ = 1.0
"""The loops hold it; of a step of 10 Hz they lose the band."""
COMPARED = (
    "delta_metric",
    "ratio_metric",
    "phase_difference_rate",
    "phase_difference_glr",
)
STATIC, ARRIVING, SPOOFER = "static", "arriving", "spoofer"


@dataclass(frozen=True)
class Case:
    """What is on the air beside the authentic signals."""

    kind: str
    """static, arriving, moving or spoofer."""
    amplitude: float
    fading_hz: float = 0.0


def compared() -> tuple[str, ...]:
    """Detectors of the comparison."""
    return tuple(name for name in COMPARED if name in detectors.DETECTORS)


def scenario(case: Case, seed: int) -> Scenario:
    """One satellite in both bands; the rest from the case, delays from the seed."""
    rng = np.random.default_rng(seed)
    return Scenario.model_validate(
        {
            "title": case.kind,
            "recording": {
                "duration_s": END_S,
                "sample_rate_hz": CORRELATOR_RATE_HZ,
                "lo_hz": 1568.259e6,
                "sample_format": "ci8",
                "seed": seed,
            },
            "satellite": [
                {
                    "prn": PRN,
                    "signals": list(BANDS),
                    "cn0_dbhz": CN0_DBHZ,
                    "range_rate_m_s": 317.0,
                    "delay_ms": 74.263,
                }
            ],
            "attack": [_spoofer(case) if case.kind == SPOOFER else _echo(case, rng)],
        }
    )


def _spoofer(case: Case) -> dict[str, Any]:
    wavelength_m = 299_792_458.0 / signal_spec("B1CP").carrier_hz
    return {
        "kind": "induced",
        "prn": PRN,
        "signals": ["B1CP"],
        "start_s": START_S - 1.0,
        "power_start_db": -20.0,
        "power_db": float(20.0 * np.log10(case.amplitude)),
        "power_ramp_s": 1.0,
        "drag_start_s": START_S,
        "drag_rate_m_s": -DRAG_HZ * wavelength_m,
        "drag_ramp_s": 0.0,
        "carrier_phase_cycles": 0.0,
    }


def _echo(case: Case, rng: np.random.Generator) -> dict[str, Any]:
    wavelength_m = 299_792_458.0 / signal_spec("B1CP").carrier_hz
    ray = {
        "ratio": case.amplitude,
        "delay_m": float(rng.uniform(*DELAYS_M)),
        "delay_rate_m_s": case.fading_hz * wavelength_m,
        "start_s": START_S if case.kind == ARRIVING else 0.0,
    }
    return {"kind": "multipath", "prns": [PRN], "system": "C", "ray": [ray]}


def run(case: Case, seed: int) -> tuple[float, ...]:
    """Largest |statistic| over its threshold after the start, for each detector; 0 for no test."""
    log = simulate(scenario(case, seed), seed=seed)
    return tuple(_score(log, name) for name in compared())


def _score(log: TrackLog, name: str) -> float:
    config = DetectionConfig()
    largest = 0.0
    for series in detectors.find(name).statistics(log, config):
        threshold = series.threshold(config.false_alarm_probability)
        late = series.time_s > START_S
        score = np.abs(series.value[late]) / threshold[late]
        largest = max(largest, float(np.max(score, initial=0.0)))
    return largest


def spoofing() -> Case:
    """The case at which every detector is set to detect 95 %."""
    return Case(SPOOFER, published.ETA)
