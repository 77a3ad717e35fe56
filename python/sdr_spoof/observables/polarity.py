"""Whether a phase that is known up to half a cycle is upside down: the message tells.

A Costas loop does not see the sign of the symbols, and its phase may be off by half a cycle. The
message does: its preamble and parity come out right, or inverted. The pilot's sign is known from
its secondary code.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from sdr_spoof.nav.records import Frame


@dataclass(frozen=True)
class Polarity:
    """Of one signal of one satellite within one run."""

    signed: bool
    """The loop knows the sign by itself."""
    starts_s: NDArray[np.float64]
    """First symbol of each frame, ascending."""
    ends_s: NDArray[np.float64]
    inverted: NDArray[np.bool_]

    def turned(self, time_s: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether half a cycle is to be added, by the last frame before (or else the next)."""
        if self.signed or not self.starts_s.size:
            return np.zeros(time_s.shape, np.bool_)
        return self.inverted[self._frame(time_s)]

    def unknown(self, time_s: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether the sign is not known: no frame, or two that differ before and after."""
        if self.signed:
            return np.zeros(time_s.shape, np.bool_)
        if not self.starts_s.size:
            return np.ones(time_s.shape, np.bool_)
        before = self._frame(time_s)
        after = np.minimum(before + 1, self.starts_s.size - 1)
        between = time_s > self.ends_s[before]
        return np.asarray(between & (self.inverted[before] != self.inverted[after]))

    def _frame(self, time_s: NDArray[np.float64]) -> NDArray[np.intp]:
        return np.maximum(np.searchsorted(self.starts_s, time_s, side="right") - 1, 0)


def polarity(
    signal: str, prn: int, frames: Iterable[Frame], from_s: float, until_s: float
) -> Polarity:
    """What the frames received in a run say of its sign."""
    signed = _core.periods_per_symbol(signal, prn) is None
    mine = sorted(
        (f.time_s, f.time_s + f.duration_s, f.inverted)
        for f in frames
        if (f.signal, f.prn, f.ok) == (signal, prn, True) and from_s <= f.time_s <= until_s
    )
    columns = list(zip(*mine, strict=True)) or [(), (), ()]
    starts, ends = (np.array(c, np.float64) for c in columns[:2])
    return Polarity(signed, starts, ends, np.array(columns[2], np.bool_))
