"""What LNAV, D1 and D2 have in common: subframes of 300 symbols from the start of the week on."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..errors import NavigationError
from .bits import PAGE_BITS
from .broadcast import Contents
from .records import Frame
from .soft import amplitude_and_noise, levelled, weighted
from .steps import Reach, reach, steps
from .sync import find, windows
from .time import WEEK_S, GnssTime
from .weeks import full_week, nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .bits import Field
    from .broadcast import Broadcast
    from .records import SymbolRun
    from .sync import Found, Framing

TRUSTED = 1e-5
"""A subframe with a wrong word is taken for right with less than this probability."""


class SubframeMessage(ABC):
    """Symbols to subframes and back, see :class:`sdr_spoof.nav.records.Message`."""

    name: str
    system: str
    symbol_s: float
    week_field: Field
    """In the subframes that tell the week."""
    preamble: NDArray[np.uint8]

    @abstractmethod
    def sent_on(self, signal: str, prn: int) -> bool:
        """Whether that satellite sends it on that registry signal."""

    @abstractmethod
    def begins(self, index: int) -> tuple[int, float]:
        """When the subframe of that count in the week begins: second of the week, and later s."""

    @abstractmethod
    def page(self, index: int, bits: NDArray[np.uint8]) -> int:
        """Page of a subframe, 0 where it has none."""

    @abstractmethod
    def tells_week(self, number: int, page: int) -> bool:
        """Whether a subframe holds the week."""

    @abstractmethod
    def head(self, bits: NDArray[np.uint8], index: int) -> None:
        """Write time and number of a subframe."""

    @abstractmethod
    def fill(self, bits: NDArray[np.uint8], content: Broadcast, index: int, week: int) -> None:
        """Write what a subframe says beside them."""

    @abstractmethod
    def to_symbols(self, bits: NDArray[np.uint8]) -> NDArray[np.int8]:
        """Symbols (F, 300) of subframes (F, 300), parity added."""

    @abstractmethod
    def framing(self, noise: float) -> Framing:
        """How subframes are told from random symbols of that noise and amplitude 1."""

    @abstractmethod
    def correct(
        self, soft: NDArray[np.float32], noise: float
    ) -> tuple[NDArray[np.uint8], NDArray[np.intp], NDArray[np.float64]]:
        """Most likely bits of subframes (F, 300), and by word corrections and doubt."""

    @abstractmethod
    def whole(self, found: list[Found], values: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Which subframes are there to the end with the sign that they began with."""

    @abstractmethod
    def failing(self, hard: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Which words (F, 10) of subframes (F, 300) of bits as received, of either sign, fail."""

    @abstractmethod
    def said(self, frame: Frame, latest: dict[int, Frame]) -> Contents:
        """What a frame says, with the latest ones that the ephemeris is put together from: it goes
        among them, by its number or its page, if it is one of them."""

    def read(self, frames: Sequence[Frame]) -> Contents:
        """Put together what the frames of one satellite say, in order of time."""
        contents = Contents()
        latest: dict[int, Frame] = {}
        for frame in frames:
            if frame.ok:
                contents += self.said(frame, latest)
        return contents.distinct()

    def start(self, week: int, index: int) -> GnssTime:
        """When a subframe begins, exactly."""
        second, later = self.begins(index)
        return GnssTime.of_week(week, second, self.system) + later

    @property
    def subframe_s(self) -> float:
        """Length of a subframe."""
        return PAGE_BITS * self.symbol_s

    def encode(self, content: Broadcast, start: GnssTime, duration_s: float) -> NDArray[np.int8]:
        """Symbols +1 and -1, see :class:`sdr_spoof.nav.records.Message`."""
        week, tow = start.week_tow(self.system)
        place = tow / self.symbol_s
        if abs(place - round(place)) > 1e-3:
            raise NavigationError(
                f"{self.name} cannot start at {tow:.6f} s of the week: begin at a whole multiple "
                f"of {self.symbol_s} s"
            )
        first, skip = divmod(round(place), PAGE_BITS)
        count = math.ceil(duration_s / self.symbol_s - 1e-6)
        subframes = range(first, first + -(-(skip + count) // PAGE_BITS))
        return self._symbols(content, week, subframes)[skip : skip + count]

    def _symbols(self, content: Broadcast, week: int, indices: range) -> NDArray[np.int8]:
        per_week = round(WEEK_S / self.subframe_s)
        bits = np.zeros((len(indices), PAGE_BITS), dtype=np.uint8)
        for row, index in zip(bits, indices, strict=True):
            later, within = divmod(index, per_week)
            row[: self.preamble.size] = self.preamble
            self.head(row, within)
            self.fill(row, content, within, week + later)
        return self.to_symbols(bits).reshape(-1)

    def decode(self, run: SymbolRun, near: GnssTime | None = None) -> list[Frame]:
        """Find and correct the subframes of a run, see :class:`sdr_spoof.nav.records.Message`."""
        levels = levelled(run.values)
        amplitude, noise = amplitude_and_noise(levels)
        if amplitude == 0.0:
            return []
        noise /= amplitude
        values = weighted((levels / amplitude).astype(np.float32), noise)
        found = find(values, self.framing(noise))
        if not found:
            return []
        starts = np.array([f.start for f in found])
        signs = np.array([f.sign for f in found], dtype=np.float32)
        bits, corrected, doubt = self.correct(windows(values, starts) * signs[:, None], noise)
        good = self.whole(found, values) & (doubt.sum(axis=1) < TRUSTED)
        times, told = self._times(found, bits, good, near)
        return [
            replace(
                self._frame(run, f, bits[n], bool(good[n]), int(corrected[n].sum())),
                transmitted=times[n],
                week_known=told,
            )
            for n, f in enumerate(found)
        ]

    def reach(self, run: SymbolRun, frame: Frame) -> Reach:
        """What is in step with a frame, see :class:`sdr_spoof.nav.records.Message`."""
        start = int(np.searchsorted(run.code_phase_chips, frame.code_phase_chips))
        times_s = np.append(run.time_s, run.time_s[-1] + self.symbol_s)
        return reach(times_s, start, *steps(run.values, start, self.failing))

    def _frame(
        self,
        run: SymbolRun,
        found: Found,
        bits: NDArray[np.uint8],
        good: bool,
        corrected: int,
    ) -> Frame:
        return Frame(
            system=self.system,
            prn=run.prn,
            signal=run.signal,
            message=self.name,
            number=found.index % 5 + 1,
            page=self.page(found.index, bits) if good else 0,
            transmitted=self.start(0, found.index),
            bits=bits,
            code_phase_chips=float(run.code_phase_chips[found.start]),
            time_s=float(run.time_s[found.start]),
            duration_s=self.subframe_s,
            corrected=corrected if good else 0,
            ok=good,
            inverted=found.sign < 0,
        )

    def _times(
        self,
        found: list[Found],
        bits: NDArray[np.uint8],
        good: NDArray[np.bool_],
        near: GnssTime | None,
    ) -> tuple[list[GnssTime], bool]:
        """When each left, and whether a subframe told the week."""
        known, at = near, None
        for n, f in enumerate(found):
            if good[n] and self.tells_week(f.index % 5 + 1, self.page(f.index, bits[n])):
                week = full_week(self.system, self.week_field.raw(bits[n]), near)
                known, at = self.start(week, f.index), f.start
                break
        if known is None:
            return [self.start(0, f.index) for f in found], False
        since = [0.0 if at is None else (f.start - at) * self.symbol_s for f in found]
        times = [self._near(f.index, known + s) for f, s in zip(found, since, strict=True)]
        return times, at is not None

    def _near(self, index: int, near: GnssTime) -> GnssTime:
        second, later = self.begins(index)
        return nearest(self.system, second, near) + later
