"""A scenario's transmissions: one emitter of the synthesis per signal component."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.signals import components, signal_spec

from .attack import Emission, Target
from .draw import integer
from .knots import added

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
    """Seed of its data symbols; None for a pilot, and where they are those of a message."""
    has_message: bool
    """Whether its data symbols are a navigation message, encoded in full."""
    data_error_rate: float
    """Share of its symbols that are not those of the seed."""
    start_s: float
    end_s: float
    emitter: Emitter


def transmissions(scenario: Scenario) -> list[Transmission]:
    """Everything on the air: authentic components first, then those of the attacks, in order."""
    authentic = [
        _transmission(scenario, target, Emission(start_s=-math.inf), AUTHENTIC)
        for satellite in scenario.satellites
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
    cn0_dbhz = satellite.signal_cn0_dbhz(target.signal) + 10 * math.log10(_share(target))
    symbols = satellite.symbols(spec) if target.has_data else None
    data_seed = _data_seed(scenario, target) if symbols is None else None
    motion = emission.motion or satellite.motion(spec, target.signal, scenario.recording.seed)
    start_s = max(emission.start_s, motion.start_s)
    end_s = math.inf if emission.end_s is None else emission.end_s
    end_s = min(end_s, motion.end_s)
    # What is on the air at either end of the recording is so beyond it: the filter reaches out.
    emitter = _core.Emitter(
        spec.id,
        satellite.prn,
        cn0_dbhz,
        range_m=motion.range_m,
        delay_s=motion.delay_s,
        phase_cycles=motion.phase_cycles + emission.phase_cycles - scenario.line_cycles,
        doppler_hz=motion.doppler_hz,
        doppler_rate_hz_s=motion.doppler_rate_hz_s,
        data_seed=data_seed,
        symbols=symbols,
        data_delay_s=emission.data_delay_s if target.has_data else 0.0,
        data_error_rate=emission.data_error_rate,
        power_db=added(motion.power_db, emission.power_db),
        code_offset_m=added(motion.code_offset_m, emission.code_offset_m),
        carrier_offset_hz=emission.carrier_offset_hz,
        start_s=start_s if start_s > 0 else -math.inf,
        end_s=end_s,
    )
    return Transmission(
        role=role,
        system=satellite.system,
        prn=satellite.prn,
        signal=spec.id,
        composite=target.signal,
        cn0_dbhz=cn0_dbhz,
        data_seed=data_seed,
        has_message=symbols is not None,
        data_error_rate=emission.data_error_rate if target.has_data else 0.0,
        start_s=max(0.0, start_s),
        end_s=min(scenario.recording.duration_s, end_s) if emission.end_s is None else end_s,
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
