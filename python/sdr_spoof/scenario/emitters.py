"""A scenario's transmissions: one emitter of the synthesis per signal component."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdr_spoof import _core
from sdr_spoof.signals import components, signal_spec

from .attacks import Profiles, profiles
from .model import SPEED_OF_LIGHT, InducedAttack, Satellite, Scenario

if TYPE_CHECKING:
    from sdr_spoof._core import Emitter
    from sdr_spoof.signals import SignalSpec


@dataclass(frozen=True)
class Transmission:
    """One signal component on the air."""

    role: str
    """'authentic' or 'spoofer'."""
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
    start_s: float
    end_s: float
    emitter: Emitter


def transmissions(scenario: Scenario) -> list[Transmission]:
    """Everything on the air: authentic components first, then the spoofers'."""
    authentic = [
        _transmission(scenario, satellite, signal, component, None)
        for satellite in scenario.satellite
        for signal in satellite.signals
        for component in components(signal)
    ]
    spoofed = [
        _transmission(scenario, target, signal, component, attack)
        for attack in scenario.attack
        if (target := scenario.target(attack)) is not None
        for signal in attack.signals
        for component in components(signal)
    ]
    return authentic + spoofed


def _transmission(
    scenario: Scenario,
    satellite: Satellite,
    signal: str,
    component: str,
    attack: InducedAttack | None,
) -> Transmission:
    spec = signal_spec(component)
    per_m_s = -spec.carrier_hz / SPEED_OF_LIGHT
    cn0_dbhz = satellite.signal_cn0_dbhz(signal) + 10 * math.log10(_share(signal, spec))
    data_seed = _data_seed(scenario, satellite, spec)
    phase_cycles = _phase_cycles(scenario, satellite, signal, spec.carrier_hz)
    start_s, end_s = 0.0, scenario.recording.duration_s
    added = Profiles([], [], [])
    if attack is not None:
        start_s, end_s = attack.start_s, end_s if attack.end_s is None else attack.end_s
        added = profiles(attack, spec.carrier_hz)
        phase_cycles += _attack_phase_cycles(scenario, attack, signal)
    emitter = _core.Emitter(
        component,
        satellite.prn,
        cn0_dbhz,
        delay_s=satellite.delay_ms * 1e-3,
        phase_cycles=phase_cycles,
        doppler_hz=satellite.range_rate * per_m_s,
        doppler_rate_hz_s=satellite.range_acceleration_m_s2 * per_m_s,
        data_seed=data_seed,
        power_db=added.power_db,
        code_offset_m=added.code_offset_m,
        carrier_offset_hz=added.carrier_offset_hz,
        # What is on the air at either end of the recording is so beyond it: the filter reaches out.
        start_s=-math.inf if attack is None else start_s,
        end_s=math.inf if attack is None or attack.end_s is None else end_s,
    )
    return Transmission(
        role="authentic" if attack is None else "spoofer",
        system=satellite.system,
        prn=satellite.prn,
        signal=component,
        composite=signal,
        cn0_dbhz=cn0_dbhz,
        data_seed=data_seed,
        start_s=start_s,
        end_s=end_s,
        emitter=emitter,
    )


def _share(signal: str, spec: SignalSpec) -> float:
    """Share of a component in the power of the signal that the scenario names."""
    total = sum(signal_spec(c).power_share for c in components(signal))
    return spec.power_share / total


def _data_seed(scenario: Scenario, satellite: Satellite, spec: SignalSpec) -> int | None:
    if _core.periods_per_symbol(spec.id, satellite.prn) is None:
        return None
    seed = scenario.recording.seed if satellite.data_seed is None else satellite.data_seed
    return _hash("data", seed, satellite.system, satellite.prn, spec.id)


def _phase_cycles(
    scenario: Scenario, satellite: Satellite, signal: str, carrier_hz: float
) -> float:
    """Received phase at 0 s, the same for all components of a signal."""
    if satellite.carrier_phase_cycles == "geometric":
        return -math.fmod(carrier_hz * satellite.delay_ms * 1e-3, 1.0)
    if satellite.carrier_phase_cycles == "random":
        names = ("phase", scenario.recording.seed, satellite.system, satellite.prn, signal)
        return _hash(*names) / 2**63
    return satellite.carrier_phase_cycles


def _attack_phase_cycles(scenario: Scenario, attack: InducedAttack, signal: str) -> float:
    if attack.carrier_phase_cycles == "random":
        names = ("attack", scenario.recording.seed, attack.system, attack.prn, signal)
        return _hash(*names) / 2**63
    return attack.carrier_phase_cycles


def _hash(*names: object) -> int:
    """63 bits from any names: the same on every machine and in every run."""
    digest = hashlib.blake2b(repr(names).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "little") >> 1
