"""Frozen records on the way from tracks to what satellites say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from .broadcast import Broadcast, Contents

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from .steps import Reach
    from .time import GnssTime


@dataclass(frozen=True)
class SymbolRun:
    """Soft symbols of one satellite's signal without a break, N of them."""

    signal: str
    """Registry name, such as B1I, L1CA, B1CD."""
    prn: int
    code_phase_chips: NDArray[np.float64]
    """Received code phase at each symbol's start, (N,): the counter of the track's column, whole
    code periods."""
    time_s: NDArray[np.float64]
    """Receiver time of each symbol's start, (N,)."""
    values: NDArray[np.float32]
    """(N,): 1 is the mean amplitude, +1 is ICD bit 0; the sign of all is undecided where the
    carrier loop is a Costas loop, and may change with a half-cycle slip. 0 where a symbol is
    missing."""
    symbol_s: float
    grouped: bool = True
    """Whether it is beyond doubt which rows of the track belong to one symbol."""


@dataclass(frozen=True)
class Frame:
    """A subframe (LNAV, D1, D2) or frame (CNV1) whose checks passed or were repaired."""

    system: str
    prn: int
    signal: str
    message: str
    """LNAV, D1, D2 or CNV1."""
    number: int
    """Subframe; 0 where a frame comes as a whole."""
    transmitted: GnssTime
    """When its first symbol left, by the satellite's clock."""
    bits: NDArray[np.uint8]
    """0 or 1, corrected, in the ICD's order (parity included, interleaving undone)."""
    code_phase_chips: float
    """Of its first symbol, by the track's counter."""
    time_s: float
    """Receiver time of its first symbol."""
    duration_s: float
    page: int = 0
    """Page within the subframe; 0 where it has none or it is unknown."""
    corrected: int = 0
    """Bits that the error correction changed."""
    ok: bool = True
    """False: some words failed; ``bits`` are then not to be read, time may be."""
    inverted: bool = False
    """Symbols came with reversed sign."""
    week_known: bool = True
    """False: the run did not tell the week; it is the nearest to the caller's date, or week 0."""

    @property
    def end_s(self) -> float:
        """Receiver time at its end."""
        return self.time_s + self.duration_s


@dataclass(frozen=True)
class Anchor:
    """The instant at which a code phase left the satellite, by the satellite's own clock.

    The transmit time at any epoch within is
    ``transmitted + (code_phase - code_phase_chips) / chip_rate``.
    """

    signal: str
    prn: int
    from_s: float
    """Receiver time from which it holds."""
    until_s: float
    code_phase_chips: float
    """Whole code periods."""
    transmitted: GnssTime


@dataclass(frozen=True)
class Navigation(Contents):
    """All that was received, or read from files."""

    frames: tuple[Frame, ...] = ()
    anchors: tuple[Anchor, ...] = ()
    notes: tuple[str, ...] = ()
    """What could not be used, and why, a sentence each."""


class Message(Protocol):
    """A navigation message: one class, one entry in :data:`sdr_spoof.nav.messages.MESSAGES`."""

    name: str
    """As RINEX 4 has it."""

    def sent_on(self, signal: str, prn: int) -> bool:
        """Whether that satellite sends it on that registry signal."""

    def encode(self, content: Broadcast, start: GnssTime, duration_s: float) -> NDArray[np.int8]:
        """Symbols +1 and -1 (bit 0 is +1).

        Symbol 0 begins at ``start`` in the satellite's own time, which must be a symbol boundary;
        the last one ends at or after ``start + duration_s``.

        Raises:
            NavigationError: if ``start`` is not, or a value does not fit its field.
        """

    def decode(self, run: SymbolRun, near: GnssTime | None = None) -> list[Frame]:
        """Frames in a run, in order; ``near`` (within half a rollover) tells the week."""

    def reach(self, run: SymbolRun, frame: Frame) -> Reach:
        """How far the run's symbols are in step with a frame of it."""

    def read(self, frames: Sequence[Frame]) -> Contents:
        """Put together what the frames of one satellite say; they come in order of time."""
