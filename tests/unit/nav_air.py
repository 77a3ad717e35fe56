"""Satellites with messages: their symbols with noise, and tracks of them from the receiver's loops.

Ephemerides are broadcast data of 2023-03-12 (tests/vectors/navigation/README.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from sdr_spoof import _core
from sdr_spoof.nav.broadcast import Broadcast, Klobuchar, UtcParameters
from sdr_spoof.nav.messages import MESSAGES, message_on
from sdr_spoof.nav.records import SymbolRun
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.records import SignalTrack, TrackLog
from sdr_spoof.row_store import RowStore
from sdr_spoof.signals import signal_spec
from sdr_spoof.sources import RecordingFormat
from sdr_spoof.tracking import TrackingConfig, core_settings

VECTORS = Path(__file__).parents[1] / "vectors" / "navigation"
FILE = VECTORS / "brd4_2023_03_12.rnx"
NOON = GnssTime.of_week(2253, 43_500.0)
"""2023-03-12 12:05 GPST; the file has ephemerides about it."""
KLOBUCHAR = {
    system: Klobuchar((1.1e-8, 2.2e-8, -6.0e-8, 0.0), (1.1e5, -4.9e4, 0.0, 6.5e4), system)
    for system in "GC"
}


@cache
def navigation():
    return read_navigation(FILE)


def content(prn, message="D1", at=NOON) -> Broadcast:
    """What a satellite sends at a time."""
    system = "G" if message == "LNAV" else "C"
    own = [e for e in navigation().ephemerides if (e.system, e.prn) == (system, prn)]
    ephemeris = min(own, key=lambda e: abs(e.toe - at))
    week = at.week_tow(system)[0]
    leap = 18 if system == "G" else 4
    utc = UtcParameters(system, 2e-9, 3e-15, GnssTime.of_week(week, 0, system), leap, week, 3, leap)
    return Broadcast(ephemeris, navigation().ephemerides, KLOBUCHAR[system], None, utc)


def signal_of(message):
    return "L1CA" if message == "LNAV" else "B1I"


def noisy_run(symbols, message, prn, cn0_dbhz, seed=1, sign=1, first_chip=0, time_s=0.0):
    """A run of symbols at a C/N0: amplitude 1 and Gaussian noise, sigma^2 = 1 / (2 C/N0 T)."""
    spec = signal_spec(signal_of(message))
    symbol_s = MESSAGES[message].symbol_s
    sigma = np.sqrt(1 / (2 * 10 ** (cn0_dbhz / 10) * symbol_s))
    rng = np.random.default_rng([seed, prn])
    values = sign * symbols + sigma * rng.standard_normal(symbols.size)
    k = np.arange(symbols.size)
    chips = first_chip + k * round(symbol_s * spec.chip_rate_hz)
    return SymbolRun(
        signal_of(message),
        prn,
        chips.astype(float),
        time_s + k * symbol_s,
        values.astype(np.float32),
        symbol_s,
    )


def air(message, prn, start, duration_s, cn0_dbhz=45.0, **more) -> SymbolRun:
    """A run of a satellite of the file."""
    symbols = MESSAGES[message].encode(content(prn, message, start), start, duration_s)
    return noisy_run(symbols, message, prn, cn0_dbhz, **more)


@dataclass(frozen=True)
class Sent:
    """A signal for :func:`track`; its code phase 0 leaves at ``LEAD_S`` before the start."""

    signal: str
    prn: int
    cn0_dbhz: float = 45.0
    doppler_hz: float = 1500.0
    travel_s: float = 0.0731
    power_db: tuple[tuple[float, float], ...] = ()
    flips: tuple[float, ...] = ()
    """Half-cycle slips: symbols change sign at these times."""
    symbols: np.ndarray | None = None


LEAD_S = 2.0


def _emitter(sent: Sent, start, duration_s):
    more = {}
    message = message_on(sent.signal, sent.prn)
    if sent.symbols is not None:
        more["symbols"] = sent.symbols
    elif message is not None:
        name = message.name
        span = duration_s + 2 * LEAD_S
        data = content(sent.prn, name, start)
        symbols = MESSAGES[name].encode(data, start + -LEAD_S, span).copy()
        times = np.arange(symbols.size) * (span / symbols.size) - LEAD_S
        for at in sent.flips:
            symbols[times >= at] *= -1
        more["symbols"] = symbols
    carrier = signal_spec(sent.signal).carrier_hz
    return _core.Emitter(
        sent.signal,
        sent.prn,
        sent.cn0_dbhz,
        delay_s=sent.travel_s - LEAD_S,
        doppler_hz=sent.doppler_hz * carrier / 1575.42e6,
        power_db=sent.power_db,
        **more,
    )


def track(*signals: Sent, start=NOON, duration_s=20.0, seed=1, config=None):
    """The receiver's tracks of signals, and the emitters."""
    emitters = [_emitter(s, start, duration_s) for s in signals]
    config = config or TrackingConfig(fallback=False)
    form = RecordingFormat(sample_format="ci8", sample_rate_hz=20.46e6, lo_hz=1568.259e6)
    simulator = _core.Simulator(
        form.sample_rate_hz,
        form.lo_hz,
        core_settings(config, form),
        emitters,
        [
            (s.signal, s.prn)
            for s in signals
            if s.signal != "B1CD" or config.data_component is False
        ],
        noise_power=512.0,
        seed=seed,
    )
    rows = RowStore(None)
    simulator.advance(round(duration_s * form.sample_rate_hz))
    rows.append(SignalTrack, simulator.take_signals())
    log = TrackLog(
        "simulated", form.sample_rate_hz, duration_s, False, rows.tracks(SignalTrack), ()
    )
    return log, emitters
