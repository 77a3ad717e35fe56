"""Symbols of B-CNAV1 for tests: an ephemeris, its broadcast, noisy runs of symbols."""

from __future__ import annotations

import numpy as np

from sdr_spoof.nav.bcnav1 import BCnav1Message
from sdr_spoof.nav.broadcast import Bdgim, Broadcast, TimeOffset, UtcParameters
from sdr_spoof.nav.ephemeris import CNAV1, Ephemeris
from sdr_spoof.nav.records import SymbolRun
from sdr_spoof.nav.time import GnssTime

WEEK, START_S = 896, 432_000
"""2023-03-10, 00:00:00 BDT."""
START = GnssTime.of_week(WEEK, START_S, "C")
MESSAGE = BCnav1Message()


def ephemeris(prn: int = 27, a: float = 27_906_400.25, **changes: object) -> Ephemeris:
    """Orbit and clock with something in every field."""
    values: dict[str, object] = {
        "system": "C", "prn": prn, "message": CNAV1, "toe": START, "toc": START + 300.0,
        "transmitted": START, "a0": -3.2e-4, "a1": 1.7e-11, "a2": -3e-19, "a": a,
        "a_dot": -0.0125, "e": 7.3e-4, "m0": -2.1, "delta_n": 3.9e-9, "delta_n_dot": -1.1e-14,
        "omega0": 0.7, "i0": 0.95, "omega": 3.1, "omega_dot": -6.9e-9, "i_dot": 1.4e-10,
        "cuc": 1.1e-5, "cus": -2.2e-6, "crc": 301.5, "crs": -88.25, "cic": 3e-8, "cis": -5e-8,
        "iode": 17, "iodc": 17 + 256, "health": 0, "accuracy_m": float("nan"),
        "group_delays_s": (("B1CP", -1.5e-9), ("B1CD", -2.6e-9), ("B2AP", 4.7e-9)),
    }  # fmt: skip
    return Ephemeris(**{**values, **changes})  # type: ignore[arg-type]


def broadcast(**changes: object) -> Broadcast:
    """All that a satellite may send."""
    own = ephemeris()
    others = tuple(ephemeris(prn, omega0=0.1 * prn, m0=-0.03 * prn) for prn in (19, 20, 21, 22))
    inclined = ephemeris(38, 42_160_000.0, i0=0.96, health=1)
    values: dict[str, object] = {
        "ephemeris": own,
        "ephemerides": (own, *others, inclined),
        "bdgim": Bdgim((21.5, -1.25, 3.0, 4.5, -6.125, 0.5, -0.25, 1.0, -2.0)),
        "utc": UtcParameters("C", 1.2e-9, -3e-15, START + 7.0, 4, 890, 3, 4, 1e-20),
        "offsets": (
            TimeOffset("C", "G", -7.5e-9, 2e-15, START),
            TimeOffset("C", "E", 1e-8, 0, START),
        ),
    }
    return Broadcast(**{**values, **changes})  # type: ignore[arg-type]


def run_of(
    symbols: np.ndarray, es_n0_db: float = 20.0, seed: int = 1, sign: float = 1.0, prn: int = 27
) -> SymbolRun:
    """Symbols in noise, at a ratio of symbol energy to noise density."""
    sigma = np.sqrt(0.5 / 10 ** (es_n0_db / 10))
    noise = sigma * np.random.default_rng(seed).standard_normal(symbols.size)
    count = np.arange(symbols.size)
    return SymbolRun(
        signal="B1CD",
        prn=prn,
        code_phase_chips=10_230.0 * (7 + count),
        time_s=0.25 + 0.01 * count,
        values=(sign * (symbols + noise)).astype(np.float32),
        symbol_s=0.01,
    )
