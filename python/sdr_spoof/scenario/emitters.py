"""A scenario's transmissions: one emitter of the synthesis per signal component."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.signals import components, signal_spec

from .attack import Emission, Target
from .base import SPEED_OF_LIGHT
from .draw import integer, uniform

if TYPE_CHECKING:
    from sdr_spoof._core import Emitter

    from .model import Scenario
    from .satellite import Satellite

AUTHENTIC = "authentic"
"""Role of what the satellites send themselves."""


@dataclass(frozen=True)
class Transmission:
    """One signal component on the air."""

    role: str
    """'authentic', or that of the attack: 'spoof', 'meacon' or 'multipath'."""
    system: str
    prn: int
    signal: str
    """Component, e.g. ``B1CP``."""
    composite: str
    """The signal as the scenario names it, e.g. ``B1C``."""
    cn0_dbhz: float
    """Of the component, before the power profile."""
    data_seed: int | None
    """Seed of its data symbols; None for a pilot."""
    data_error_rate: float
    """Share of its symbols that are not those of the seed."""
    start_s: float
    end_s: float
    emitter: Emitter


def transmissions(scenario: Scenario) -> list[Transmission]:
    """Everything on the air: authentic components first, then those of the attacks, in order."""
    authentic = [
        _transmission(scenario, target, Emission(start_s=-math.inf), AUTHENTIC)
        for satellite in scenario.satellite
        for target in _targets(satellite, satellite.signals)
    ]
    added = [
        _transmission(scenario, target, emission, attack.role)
        for number, attack in enumerate(scenario.attack)
        for satellite, signals in scenario.victims(number)
        for target in _targets(satellite, signals)
        for emission in attack.emissions(target, scenario.draw(number))
    ]
    return authentic + added


def _targets(satellite: Satellite, signals: tuple[str, ...]) -> list[Target]:
    return [Target(satellite, s, signal_spec(c)) for s in signals for c in components(s)]


def _transmission(
    scenario: Scenario, target: Target, emission: Emission, role: str
) -> Transmission:
    satellite, spec = target.satellite, target.spec
    per_m_s = -spec.carrier_hz / SPEED_OF_LIGHT
    cn0_dbhz = satellite.signal_cn0_dbhz(target.signal) + 10 * math.log10(_share(target))
    data_seed = _data_seed(scenario, target)
    # What is on the air at either end of the recording is so beyond it: the filter reaches out.
    emitter = _core.Emitter(
        spec.id,
        satellite.prn,
        cn0_dbhz,
        delay_s=satellite.delay_ms * 1e-3,
        phase_cycles=_phase_cycles(scenario, target) + emission.phase_cycles,
        doppler_hz=satellite.range_rate * per_m_s,
        doppler_rate_hz_s=satellite.range_acceleration_m_s2 * per_m_s,
        data_seed=data_seed,
        data_delay_s=emission.data_delay_s if target.has_data else 0.0,
        data_error_rate=emission.data_error_rate,
        power_db=emission.power_db,
        code_offset_m=emission.code_offset_m,
        carrier_offset_hz=emission.carrier_offset_hz,
        start_s=emission.start_s if emission.start_s > 0 else -math.inf,
        end_s=math.inf if emission.end_s is None else emission.end_s,
    )
    return Transmission(
        role=role,
        system=satellite.system,
        prn=satellite.prn,
        signal=spec.id,
        composite=target.signal,
        cn0_dbhz=cn0_dbhz,
        data_seed=data_seed,
        data_error_rate=emission.data_error_rate if target.has_data else 0.0,
        start_s=max(0.0, emission.start_s),
        end_s=scenario.recording.duration_s if emission.end_s is None else emission.end_s,
        emitter=emitter,
    )


def _share(target: Target) -> float:
    """Share of a component in the power of the signal that the scenario names."""
    total = sum(signal_spec(c).power_share for c in components(target.signal))
    return target.spec.power_share / total


def _data_seed(scenario: Scenario, target: Target) -> int | None:
    if not target.has_data:
        return None
    satellite = target.satellite
    seed = scenario.recording.seed if satellite.data_seed is None else satellite.data_seed
    return integer("data", seed, satellite.system, satellite.prn, target.spec.id)


def _phase_cycles(scenario: Scenario, target: Target) -> float:
    """Received phase at 0 s, the same for all components of a signal."""
    satellite = target.satellite
    if satellite.carrier_phase_cycles == "geometric":
        return -math.fmod(target.spec.carrier_hz * satellite.delay_ms * 1e-3, 1.0)
    if satellite.carrier_phase_cycles == "random":
        seed = scenario.recording.seed
        return uniform("phase", seed, satellite.system, satellite.prn, target.signal)
    return satellite.carrier_phase_cycles
