"""A scenario with one attack, and what its emitters differ by from the authentic ones."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from correlation import FS_HZ, LO_HZ

from sdr_spoof.scenario import Scenario, Transmission, transmissions
from sdr_spoof.signals import signal_spec

C = 299_792_458.0


def scenario(
    attack: dict[str, Any], duration_s: float = 20.0, prns: tuple[int, ...] = (19, 27), **more: Any
) -> Scenario:
    """Moving satellites with B1I and B1C, and the attack."""
    satellites = [{"prn": p, "range_rate_m_s": 10.0 * p, "delay_ms": 70 + p} | more for p in prns]
    recording = {"duration_s": duration_s, "sample_rate_hz": FS_HZ, "lo_hz": LO_HZ}
    return Scenario.model_validate(
        {
            "recording": recording | {"sample_format": "ci8"},
            "satellite": satellites,
            "attack": [attack],
        }
    )


@dataclass(frozen=True)
class Difference:
    """An emitter less the authentic one of the same satellite and component."""

    at_s: np.ndarray
    code_m: np.ndarray
    """Positive: later."""
    phase_cycles: np.ndarray
    """Received phase, grows with approach."""
    power_db: np.ndarray
    """Minus infinity off the air."""

    @property
    def phasor(self) -> np.ndarray:
        """Amplitude and phase against the authentic carrier."""
        amplitude = 10 ** (self.power_db / 20)
        return np.asarray(amplitude * np.exp(2j * np.pi * self.phase_cycles))


def added(made: Scenario, prn: int, signal: str) -> list[Transmission]:
    """What attacks add to one component."""
    found = [t for t in transmissions(made) if (t.prn, t.signal) == (prn, signal)]
    return [t for t in found if t.role != "authentic"]


def authentic(made: Scenario, prn: int, signal: str) -> Transmission:
    found = [t for t in transmissions(made) if (t.prn, t.signal) == (prn, signal)]
    return next(t for t in found if t.role == "authentic")


def differences(made: Scenario, prn: int, signal: str, at_s: np.ndarray) -> list[Difference]:
    """Of every emitter that an attack adds to a component."""
    true = authentic(made, prn, signal).emitter
    rate_hz = signal_spec(signal).chip_rate_hz
    return [
        Difference(
            at_s,
            -(t.emitter.code_phase_chips(at_s) - true.code_phase_chips(at_s)) * C / rate_hz,
            t.emitter.received_phase_cycles(at_s) - true.received_phase_cycles(at_s),
            t.emitter.cn0_dbhz(at_s) - true.cn0_dbhz(at_s),
        )
        for t in added(made, prn, signal)
    ]


def difference(made: Scenario, prn: int, signal: str, at_s: np.ndarray) -> Difference:
    """Of the only one."""
    (only,) = differences(made, prn, signal, at_s)
    return only
