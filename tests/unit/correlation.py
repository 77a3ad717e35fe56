"""Correlation with what an emitter sends, written down from the definitions."""

import numpy as np

from sdr_spoof import _core

FS_HZ = 25e6
LO_HZ = 1568.259e6


def iq(raw: np.ndarray) -> np.ndarray:
    """Complex samples of ``ci8`` bytes."""
    values = _core.unpack("ci8", raw).astype(float)
    return values[::2] + 1j * values[1::2]


def prompt(e: _core.Emitter, start: int, x: np.ndarray) -> complex:
    """Mean of the samples ``x``, from sample ``start`` on, times the emitter's replica."""
    spec = _core.signal_spec(e.signal)
    length = spec["code_length"]
    t = np.arange(start, start + x.size) / FS_HZ
    chips = e.code_phase_chips(t)
    chip = np.floor(chips).astype(np.int64)
    replica = _core.code_chips(e.signal, e.prn)[chip % length].astype(float)
    secondary = _core.secondary_chips(e.signal, e.prn)
    if secondary.size:
        replica *= secondary[chip // length % secondary.size]
    per_symbol = _core.periods_per_symbol(e.signal, e.prn)
    if per_symbol:
        late = round(e.data_delay_s * spec["chip_rate_hz"])
        replica *= e.data_symbols((chip - late) // (length * per_symbol))
    if spec["modulation"] == "Boc11":
        replica *= np.where(chips - chip < 0.5, 1, -1)
    turn = (spec["carrier_hz"] - LO_HZ) * t + e.received_phase_cycles(t)
    return complex(np.mean(x * replica * np.exp(-2j * np.pi * turn)))
