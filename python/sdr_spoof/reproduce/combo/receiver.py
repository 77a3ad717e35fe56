"""The published attack through the whole receiver: one run is a function of point and seed.

Timeline: both bands clean until the spoofer comes on the air, aligned in code and phase; its power
grows to eta within a second; then it drags code and carrier of B1C at a constant f_e.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import detectors
from sdr_spoof.correlator_level import simulate
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.records import Acquisition, State
from sdr_spoof.scenario import Scenario, transmissions
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.signals import signal_spec
from sdr_spoof.tracking import TrackingConfig, track

if TYPE_CHECKING:
    from sdr_spoof.records import TrackLog

CORRELATOR, IF = "correlator", "if"
GAP_S = 0.1
"""A longer gap between joint epochs is a loss."""
PRN = 27
BANDS = ("B1I", "B1CP")
ON_AIR_S, DRAG_S, END_S = 5.0, 6.0, 11.0
IF_RATE_HZ = 20e6
"""Enough for B1I and the BOC(1,1) part of B1C, which has 29/33 of the pilot's power."""
CORRELATOR_RATE_HZ = 40e6
LOWEST_DBHZ = 10.0
"""Given up, or not tested, only below this C/N0: the question is what the loops hold."""
LOOPS = TrackingConfig(cn0_min_dbhz=LOWEST_DBHZ)


@dataclass(frozen=True)
class Point:
    """One point of a sweep."""

    cn0_dbhz: float
    drag_hz: float
    eta: float
    """0 for no spoofer."""
    level: str = CORRELATOR


@dataclass(frozen=True)
class Method:
    """A detector with its settings."""

    name: str
    title: str
    config: DetectionConfig


@dataclass(frozen=True)
class Run:
    """What one run gave."""

    held: bool
    """Both bands were tracked together when the spoofer came."""
    lost_s: float
    """From the start of the drag until joint tracking broke for the first time, NaN for never."""
    early: tuple[bool, ...]
    """An alarm before the spoofer was on the air, for each method."""
    latency_s: tuple[float, ...]
    """From the start of the drag to the alarm, for each method, NaN for none. Negative: the alarm
    came while the power grew."""


def methods() -> tuple[Method, ...]:
    """The published test, its sharper thermal form, and the jump-and-slope GLR."""
    base = DetectionConfig(min_cn0_dbhz=LOWEST_DBHZ)
    rate = "phase_difference_rate"
    return (
        Method(
            rate, "rate (published law)", base.model_copy(update={"threshold_model": "published"})
        ),
        Method(rate, "rate (thermal law)", base.model_copy(update={"threshold_model": "thermal"})),
        Method("phase_difference_glr", "jump and slope GLR", base),
    )


def scenario(point: Point, seed: int) -> Scenario:
    """The published experiment at one point, each band at the stated C/N0."""
    rate_hz = IF_RATE_HZ if point.level == IF else CORRELATOR_RATE_HZ
    wavelength_m = 299_792_458.0 / signal_spec("B1CP").carrier_hz
    attack = {
        "prn": PRN,
        "signals": ["B1CP"],
        "start_s": ON_AIR_S,
        "power_start_db": -20.0,
        "power_db": 20.0 * np.log10(max(point.eta, 1e-6)),
        "power_ramp_s": DRAG_S - ON_AIR_S,
        "drag_start_s": DRAG_S,
        "drag_rate_m_s": -point.drag_hz * wavelength_m,
        "drag_ramp_s": 0.0,
        "carrier_phase_cycles": 0.0,
    }
    return Scenario.model_validate(
        {
            "title": f"{point.cn0_dbhz:g} dB-Hz, f_e {point.drag_hz:g} Hz, eta {point.eta:g}",
            "recording": {
                "duration_s": END_S,
                "sample_rate_hz": rate_hz,
                "lo_hz": 1568.259e6,
                "sample_format": "ci8",
                "seed": seed,
            },
            "satellite": [
                {
                    "prn": PRN,
                    "signals": list(BANDS),
                    "cn0_dbhz": point.cn0_dbhz,
                    "range_rate_m_s": 317.0,
                    "delay_ms": 74.263,
                }
            ],
            "attack": [attack] if point.eta > 0 else [],
        }
    )


def received(point: Point, seed: int) -> TrackLog:
    """Tracks of one run at the point's level, by the receiver's own loops."""
    plan = scenario(point, seed)
    if point.level == IF:
        return track(LiveRecording(plan, 1), seeds(plan), LOOPS, threads=1)
    return simulate(plan, LOOPS, seed=seed)


def seeds(plan: Scenario) -> list[Acquisition]:
    """What a good acquisition of the first sample would be, errors included."""
    found = []
    for t in transmissions(plan)[: len(BANDS)]:  # the authentic ones come first
        spec = signal_spec(t.signal)
        phase = float(t.emitter.code_phase_chips(np.zeros(1))[0])
        doppler_hz = float(t.emitter.doppler_hz(np.zeros(1))[0]) + 4.0
        delay_s = (-phase % spec.code_length + 0.02) / spec.chip_rate_hz
        found.append(Acquisition(t.signal, t.prn, True, 0, doppler_hz, delay_s, 0, 0, 0, 0))
    return found


def run(point: Point, seed: int) -> Run:
    """One run; the same point and seed give the same result."""
    log = received(point, seed)
    alarms = [_alarm_s(log, method) for method in methods()]
    return Run(
        held=_held(log),
        lost_s=_lost_s(log) - DRAG_S,
        early=tuple(a < ON_AIR_S for a in alarms),
        latency_s=tuple(a - DRAG_S for a in alarms),
    )


def _alarm_s(log: TrackLog, method: Method) -> float:
    """First test beyond the threshold, as the threshold rule has it; NaN for none."""
    first_s = np.inf
    for series in detectors.find(method.name).statistics(log, method.config):
        beyond = np.abs(series.value) > series.threshold(method.config.false_alarm_probability)
        first_s = min(first_s, float(np.min(series.time_s[beyond], initial=np.inf)))
    return first_s if np.isfinite(first_s) else float("nan")


def _held(log: TrackLog) -> bool:
    """Joint epochs of both bands throughout the half second before the spoofer."""
    near = [combo.between(ON_AIR_S - 0.5, ON_AIR_S) for combo in log.combos]
    return any(c.epochs > 45 and bool((c.state >= State.SYNCED).all()) for c in near)


def _lost_s(log: TrackLog) -> float:
    """When joint tracking broke after the spoofer came on the air, NaN for never."""
    for combo in log.combos:
        after = combo.between(ON_AIR_S - 0.5, END_S)
        good = after.time_s[after.state >= State.SYNCED]
        ends = np.append(good, END_S)
        gaps = np.flatnonzero(np.diff(ends) > GAP_S)
        if gaps.size:
            return float(ends[gaps[0]])
    return float("nan")
