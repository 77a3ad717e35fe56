"""The epochs: whole multiples of an interval of receiver time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.time import GnssTime

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .clock import ClockPiece, ReceiverClock


@dataclass(frozen=True)
class Epochs:
    """E instants of receiver time, and the clock that each goes by."""

    reference: GnssTime
    time_s: NDArray[np.float64]
    sample_time_s: NDArray[np.float64]
    pieces: tuple[tuple[int, int, ClockPiece], ...]
    """(first epoch, one past the last, clock)."""


def epochs_of(clock: ReceiverClock, rate_hz: int, from_s: float, until_s: float) -> Epochs:
    """Epochs between two sample times. A clock that was set back leaves some out."""
    reference = GnssTime(clock.pieces[0].at(from_s).seconds)
    times: list[NDArray[np.float64]] = []
    samples: list[NDArray[np.float64]] = []
    pieces = []
    next_epoch, at = -(1 << 62), 0
    for start_s, stop_s, piece in clock.spans(until_s):
        first = math.ceil(piece.since(reference, max(start_s, from_s)) * rate_hz)
        last = math.floor(piece.since(reference, stop_s) * rate_hz)
        numbers = np.arange(max(first, next_epoch), last + 1)
        times.append(numbers / rate_hz)
        samples.append(piece.samples_at(reference, times[-1]))
        pieces.append((at, at + numbers.size, piece))
        at += numbers.size
        next_epoch = max(last + 1, next_epoch)
    return Epochs(reference, np.concatenate(times), np.concatenate(samples), tuple(pieces))
