"""The carrier-scaled phase difference of the two sidebands of one satellite, slips taken out.

Both carriers come from one clock and travel one path, so phi_u - (f_u / f_l) phi_l (cycles at f_u)
stands still whatever the satellite, the user and the receiver clock do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdr_spoof import _core
from sdr_spoof.detectors.windows import segments
from sdr_spoof.records import ComboTrack, State, Track

Repair = Callable[[NDArray[np.float64], float, float], tuple[NDArray[np.float64], int]]
"""From phase, slip quantum and sigma (all in cycles) to the repaired phase and how many slips."""


@dataclass(frozen=True)
class Difference:
    """The carrier-scaled phase difference of a combo track, cycles at f_u, M rows."""

    carrier_ratio: float
    epoch_s: float
    cycles: NDArray[np.float64]
    """Slips taken out; NaN where it is not used."""
    pieces: tuple[slice, ...]
    """Unbroken, settled pieces of tracking."""
    slips: int


def scaled_difference(
    track: ComboTrack,
    settle_s: float,
    repair: Repair,
    there: NDArray[np.bool_] | None = None,
) -> Difference:
    """phi_u - (f_u / f_l) phi_l with slips repaired, on the settled pieces.

    Rows that are not ``there``, shape (M,), had no signal and are left out.
    """
    lower, upper = _core.signal_spec(track.lower), _core.signal_spec(track.upper)
    ratio = float(upper["carrier_hz"] / lower["carrier_hz"])
    epoch_s = epoch_of(track)
    usable = (
        (track.state >= State.SYNCED)
        & np.isfinite(track.phase_lower_cycles + track.phase_upper_cycles)
        & np.isfinite(track.cn0_lower_dbhz + track.cn0_upper_dbhz)
        & (True if there is None else there)
    )
    pieces = settled(track.time_s, usable, round(settle_s / epoch_s))
    cycles = np.full(track.time_s.size, np.nan)
    slips = 0
    for piece in pieces:
        both = []
        for name, phase, cn0 in (
            (track.upper, track.phase_upper_cycles, track.cn0_upper_dbhz),
            (track.lower, track.phase_lower_cycles, track.cn0_lower_dbhz),
        ):
            sigma = float(phase_sigma_cycles(float(np.mean(ratio_hz(cn0[piece]))), epoch_s))
            clean, count = repair(phase[piece], slip_quantum(name, track.prn), sigma)
            both.append(clean)
            slips += count
        cycles[piece] = both[0] - ratio * both[1]
    return Difference(ratio, epoch_s, cycles, pieces, slips)


def slip_quantum(signal: str, prn: int) -> float:
    """Smallest cycle slip of a signal's loop: half a cycle with data (Costas), one for a pilot."""
    return 1.0 if _core.periods_per_symbol(signal, prn) is None else 0.5


def phase_sigma_cycles(cn0_hz: float | NDArray[np.float64], epoch_s: float) -> NDArray[np.float64]:
    """White noise of one epoch's measured phase, with the arctangent's squaring loss, in cycles.

    sigma^2 = (1 / (2 C/N0 T)) (1 + 1 / (2 C/N0 T)) rad^2; ``cn0_hz`` is a ratio in Hz.
    """
    variance = 1.0 / (2.0 * np.asarray(cn0_hz, dtype=np.float64) * epoch_s)
    return np.asarray(np.sqrt(variance * (1.0 + variance)) / (2.0 * np.pi))


def epoch_of(track: Track) -> float:
    """Length of an epoch of a track in memory, in s."""
    return float(np.median(track.integration_s)) if track.integration_s.size else 0.01


def settled(
    time_s: NDArray[np.float64], usable: NDArray[np.bool_], settle: int
) -> tuple[slice, ...]:
    """Unbroken pieces of usable rows, each without its first ``settle`` rows."""
    return tuple(
        slice(piece.start + settle, piece.stop)
        for piece in segments(time_s, usable)
        if piece.stop - piece.start - settle >= 2
    )


def ratio_hz(cn0_dbhz: NDArray[np.float64]) -> NDArray[np.float64]:
    """C/N0 as a ratio in Hz."""
    return np.asarray(10.0 ** (cn0_dbhz / 10.0))
