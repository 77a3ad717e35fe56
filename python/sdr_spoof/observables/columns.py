"""One column of the observations: a span of a signal, read at the epochs."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Self

import numpy as np

from sdr_spoof.signals import LIGHT_M_S

from .clock import ClockPiece, plausible
from .fit import Stencil, stencil
from .transmit import Span, delay_offset_s

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .epochs import Epochs
    from .polarity import Polarity


@dataclass(frozen=True)
class Column:
    """Values of one signal at E epochs; NaN where there is none."""

    pseudorange_m: NDArray[np.float64]
    carrier_phase_cycles: NDArray[np.float64]
    doppler_hz: NDArray[np.float64]
    cn0_dbhz: NDArray[np.float64]
    unsettled_m: NDArray[np.float64]
    lock_lost: NDArray[np.bool_]
    half_cycle: NDArray[np.bool_]
    spoofed: NDArray[np.bool_]

    @classmethod
    def empty(cls, epochs: int) -> Self:
        """Nothing yet."""
        numbers = [np.full(epochs, np.nan) for _ in range(5)]
        return cls(*numbers, *(np.zeros(epochs, np.bool_) for _ in range(3)))

    def put(self, at: slice, other: Column) -> None:
        """Fill in a part; for who makes the column only."""
        for field in fields(self):
            getattr(self, field.name)[at] = getattr(other, field.name)

    @property
    def seen(self) -> bool:
        """Whether there is anything in it."""
        return bool(
            np.isfinite(self.pseudorange_m).any() or np.isfinite(self.carrier_phase_cycles).any()
        )


def fill(
    column: Column, span: Span, sign: Polarity | None, epochs: Epochs, window_s: float
) -> bool:
    """Put what a span says into a column; False where its delay is not that of a satellite.

    ``sign`` is None for a span without a carrier phase.
    """
    fits = True
    count = round(window_s / span.run.integration_s)
    for begin, end, piece in epochs.pieces:
        samples = epochs.sample_time_s[begin:end]
        a, b = np.searchsorted(samples, (span.from_s, np.nextafter(span.until_s, np.inf)))
        if b <= a:
            continue
        if not plausible(span, piece):
            fits = False
            continue
        part = stencil(span.run.time_s, samples[a:b], count)
        column.put(
            slice(int(begin + a), int(begin + b)), _read(span, sign, piece, samples[a:b], part)
        )
    return fits


def _read(
    span: Span, sign: Polarity | None, piece: ClockPiece, samples: NDArray[np.float64], at: Stencil
) -> Column:
    """Values at sample times within a span and one piece of the clock."""
    run = span.run
    delay_s = delay_offset_s(span.origin, piece.time, piece.sample_s) - at.values(run.code_s)
    range_m = LIGHT_M_S * (delay_s + piece.rate * (samples - piece.sample_s))
    column = Column(
        pseudorange_m=np.where(at.every(run.settled), range_m, np.nan),
        carrier_phase_cycles=np.full(samples.size, np.nan),
        doppler_hz=np.full(samples.size, np.nan),
        cn0_dbhz=np.interp(samples, run.time_s, run.cn0_dbhz),
        unsettled_m=LIGHT_M_S * np.interp(samples, run.time_s, run.unsettled_s),
        lock_lost=np.zeros(samples.size, np.bool_),
        half_cycle=np.zeros(samples.size, np.bool_),
        spoofed=at.some(run.captured),
    )
    if sign is not None:
        _read_carrier(column, span, sign, piece, samples, at, range_m)
    return column


def _read_carrier(
    column: Column,
    span: Span,
    sign: Polarity,
    piece: ClockPiece,
    samples: NDArray[np.float64],
    at: Stencil,
    range_m: NDArray[np.float64],
) -> None:
    """Phase, Doppler and their flags, against the receiver's clock instead of the samples'."""
    run, carrier_hz = span.run, span.run.spec.carrier_hz
    clean = ~at.some(run.slipped)
    turned = sign.turned(samples)
    gained = carrier_hz * piece.rate
    phase = at.values(run.phase_cycles) + gained * (samples - piece.sample_s) + 0.5 * turned
    doppler = -(at.slopes(run.phase_cycles) + gained) / (1.0 + piece.rate)
    where = np.flatnonzero(clean)
    if not where.size:
        return
    # The same whole number for the whole run: from where the span has its first phase.
    whole = np.round(range_m[where[0]] * carrier_hz / LIGHT_M_S - phase[where[0]])
    column.carrier_phase_cycles[where] = phase[where] + whole
    column.doppler_hz[where] = doppler[where]
    column.half_cycle[:] = sign.unknown(samples)
    column.lock_lost[where] = _lost(run.time_s, run.slipped, samples[where], turned[where])


def _lost(
    row_times_s: NDArray[np.float64],
    slipped: NDArray[np.bool_],
    samples: NDArray[np.float64],
    turned: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Whether the phase may have slipped since the instant before; at the first, yes."""
    slips = np.concatenate([[0], np.cumsum(slipped)])[np.searchsorted(row_times_s, samples)]
    return np.concatenate([[True], (np.diff(slips) > 0) | (turned[1:] != turned[:-1])])
