"""One fix from what acquisition found: recordings too short to be tracked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.nav.time import GnssTime
from sdr_spoof.observations import Observations, ObservedSignal
from sdr_spoof.pvt import code_phases, snapshot
from sdr_spoof.pvt.snapshot import CodePhase

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.fixes import Fixes
    from sdr_spoof.nav.store import Store
    from sdr_spoof.pvt import PvtConfig
    from sdr_spoof.records import Acquisition


def single_fix(
    acquisitions: Sequence[Acquisition],
    sample_rate_hz: float,
    store: Store,
    start: GnssTime,
    place_m: NDArray[np.float64],
    config: PvtConfig,
) -> tuple[Observations, Fixes] | None:
    """A snapshot at the sample of the acquisitions; None where nothing was detected.

    The observations hold C/N0 and Doppler only: code phases without whole periods are no
    pseudoranges.
    """
    found = [a for a in acquisitions if a.detected]
    if not found:
        return None
    sample = found[0].sample_index
    phases = code_phases(found, sample_rate_hz, sample)
    at_s = sample / sample_rate_hz
    fixes = snapshot(phases, store, place_m, start + at_s, config)
    return _observations(phases, start + at_s, at_s), fixes


def _observations(phases: Sequence[CodePhase], time: GnssTime, at_s: float) -> Observations:
    shape = (1, len(phases))
    nothing, no = np.full(shape, np.nan), np.zeros(shape, np.bool_)
    return Observations(
        reference=time,
        time_s=np.zeros(1),
        sample_time_s=np.array([at_s]),
        interval_s=1.0,
        signals=tuple(ObservedSignal(p.system, p.prn, p.signal) for p in phases),
        pseudorange_m=nothing,
        carrier_phase_cycles=nothing,
        doppler_hz=np.array([[p.doppler_hz for p in phases]]),
        cn0_dbhz=np.array([[p.cn0_dbhz for p in phases]]),
        lock_lost=no,
        half_cycle=~no,
        spoofed=no,
    )
