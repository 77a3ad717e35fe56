"""Which ephemeris each signal uses at each epoch."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.fixes import Cause
from sdr_spoof.nav.ephemeris import CNAV1, D1, D2, LNAV, Ephemeris
from sdr_spoof.nav.store import Selected, Store

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.observations import Observations, ObservedSignal

CHOSEN_EVERY_S = 30.0
"""An ephemeris serves so long before it is asked whether there is a better one."""
CNAV1_SIGNALS = ("B1CP", "B1CD")
"""Signals whose group delays this message states, and no other; nor it those of other signals."""
OTHERS = (D1, D2, LNAV)


@dataclass(frozen=True)
class Choice:
    """Ephemerides, and rows of them by epoch and signal."""

    ephemerides: tuple[Ephemeris, ...]
    row: NDArray[np.int32]
    """(E, S); -1 where there is none fit for use."""
    known: NDArray[np.int32]
    """(E, S): as ``row``, but also of satellites unhealthy or stale."""
    cause: NDArray[np.uint8]
    """(E, S): USED, or why there is none."""


def choose(observations: Observations, store: Store) -> Choice:
    """The best ephemeris of each signal for each half minute."""
    shape = (observations.epochs, len(observations.signals))
    row, known = np.full(shape, -1, np.int32), np.full(shape, -1, np.int32)
    cause = np.full(shape, Cause.NO_EPHEMERIS, np.uint8)
    ephemerides: dict[int, tuple[int, Ephemeris]] = {}
    spans = _spans(observations.time_s)
    for column, signal in enumerate(observations.signals):
        for start, stop in spans:
            selected = _select(store, signal, observations, (start + stop - 1) // 2)
            if selected is None:
                continue
            e = selected.ephemeris
            at = ephemerides.setdefault(id(e), (len(ephemerides), e))[0]
            known[start:stop, column] = at
            cause[start:stop, column] = _verdict(selected)
    row[cause == Cause.USED] = known[cause == Cause.USED]
    return Choice(tuple(e for _, e in ephemerides.values()), row, known, cause)


def _spans(time_s: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Runs of epochs, each no longer than :data:`CHOSEN_EVERY_S`."""
    if not time_s.size:
        return []
    block = np.floor((time_s - time_s[0]) / CHOSEN_EVERY_S)
    edges = [0, *(np.flatnonzero(np.diff(block)) + 1).tolist(), time_s.size]
    return list(pairwise(edges))


def _select(
    store: Store, signal: ObservedSignal, observations: Observations, epoch: int
) -> Selected | None:
    time = observations.time(epoch)
    own = (CNAV1,) if signal.signal in CNAV1_SIGNALS else OTHERS
    selected = store.select(signal.system, signal.prn, time, own)
    if selected is not None and not selected.stale:
        return selected
    return store.select(signal.system, signal.prn, time)


def _verdict(selected: Selected) -> Cause:
    if selected.stale:
        return Cause.STALE
    return Cause.USED if selected.healthy else Cause.UNHEALTHY
