"""One signal of each satellite: which of those observed measurements are made of."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.fixes import Cause
from sdr_spoof.observations import SUBCARRIER
from sdr_spoof.pvt import PvtConfig
from sdr_spoof.pvt.ranges import code_sigma_m

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.observations import Observations

ENOUGH = 0.9
"""A signal with less noise may be there at so much fewer epochs."""
_BY_EPOCH = (
    *("pseudorange_m", "carrier_phase_cycles", "doppler_hz", "cn0_dbhz"),
    *("lock_lost", "half_cycle", "spoofed"),
)


def best_columns(observations: Observations, cause: NDArray[np.uint8]) -> list[int]:
    """Columns of the observations, one a satellite, in their order.

    Of the signals that are usable at nearly as many epochs as the best, the one whose code has the
    least noise; satellites of which nothing is usable, spoofed or not, have none.

    Args:
        observations: what was observed.
        cause: why signals cannot be used (E, S), values of :class:`Cause`.
    """
    clean = np.count_nonzero(cause == Cause.USED, axis=0)
    heard = clean + np.count_nonzero(cause == Cause.SPOOFED, axis=0)
    chosen = []
    for name in observations.satellites:
        own = [
            k
            for k, s in enumerate(observations.signals)
            if s.satellite == name and s.signal != SUBCARRIER and heard[k]
        ]
        if own:
            chosen.append(_best(observations, own, clean if clean[own].any() else heard))
    return chosen


def _best(observations: Observations, own: list[int], count: NDArray[np.intp]) -> int:
    """Pilots before data components, by their power."""
    most = max(count[k] for k in own)

    def worth(k: int) -> tuple[float, float]:
        noise = code_sigma_m(observations.signals[k].signal, PvtConfig())
        return noise, -float(np.nanmean(observations.cn0_dbhz[:, k]))

    return min((k for k in own if count[k] >= ENOUGH * most), key=worth)


def only(observations: Observations, columns: list[int]) -> Observations:
    """Some of the signals."""
    unsettled_m = observations.unsettled_m
    return dataclasses.replace(
        observations,
        signals=tuple(observations.signals[k] for k in columns),
        unsettled_m=None if unsettled_m is None else unsettled_m[:, columns],
        **{name: getattr(observations, name)[:, columns] for name in _BY_EPOCH},
    )
