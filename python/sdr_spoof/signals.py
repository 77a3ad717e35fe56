"""Typed access to the signal registry of the core."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from . import _core
from .errors import SignalError

LIGHT_M_S = 299_792_458.0
"""Speed of light in a vacuum (SI)."""


@dataclass(frozen=True)
class SignalSpec:
    """One signal component, as its ICD defines it (``description`` names the ICD)."""

    id: str
    """Registry name, e.g. ``B1CP``."""
    composite: str
    """The signal it is part of, e.g. ``B1C``."""
    description: str
    rinex: str
    """RINEX observation code letters, e.g. ``1P``."""
    system: str
    """RINEX system letter."""
    carrier_hz: float
    chip_rate_hz: float
    code_length: int
    modulation: str
    power_share: float
    """Share of the composite signal's power."""
    phase_offset_cycles: float
    """Carrier phase relative to the composite's reference component."""
    min_half_bandwidth_hz: float
    """Half bandwidth around the carrier that a recording must hold."""
    prns: tuple[int, ...]
    """PRNs that transmit it."""

    @property
    def period_s(self) -> float:
        """Code period in seconds."""
        return self.code_length / self.chip_rate_hz


def signal_ids() -> list[str]:
    """Registry names of all signals."""
    return _core.signal_ids()


@cache
def signal_spec(signal: str) -> SignalSpec:
    """Specification of a signal.

    Raises:
        SignalError: if the registry has no such signal (the message lists the known ones).
    """
    try:
        values = _core.signal_spec(signal)
    except ValueError as error:
        raise SignalError(str(error)) from error
    return SignalSpec(**{**values, "prns": tuple(values["prns"])})


def system_of(signal: str) -> str:
    """RINEX system letter of a signal."""
    return signal_spec(signal).system


def coherent_pairs() -> tuple[tuple[str, str], ...]:
    """Pairs of signals with coherent carriers, which are tracked as one by default."""
    return tuple(_core.signal_pairs())


def components(name: str) -> list[str]:
    """Components of a composite signal (``B1C`` -> B1CD, B1CP), or the one signal so named.

    Raises:
        SignalError: if neither is known.
    """
    try:
        return _core.signal_components(name)
    except ValueError as error:
        raise SignalError(str(error)) from error


def satellite_name(system: str, prn: int) -> str:
    """RINEX satellite name, e.g. C23; L1 C/A of SBAS and QZSS: S28 is PRN 128, J01 PRN 193."""
    if system == "G" and prn >= 193:
        return f"J{prn - 192:02d}"
    if system == "G" and prn >= 120:
        return f"S{prn - 100:02d}"
    return f"{system}{prn:02d}"
