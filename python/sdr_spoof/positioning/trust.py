"""Fixes without satellites under suspicion, where the detectors call another one spoofed.

Alone, a suspicion may be an echo, and the satellite is used. Where one satellite is spoofed, those
under suspicion hardly are innocent: a counterfeit of the whole sky is proven on some satellites
before it is on the others. They are left out of every epoch that has a fix without them; not those
suspected for the noise of the band alone, which a counterfeit of any satellite raises for all.
Where there is no fix so, all are used. Fixes on satellites under suspicion the route calls suspect.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import detectors, pvt
from sdr_spoof.fixes import Status
from sdr_spoof.fusion import SPOOFED, SUSPECT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.fixes import Fixes
    from sdr_spoof.nav.records import Navigation
    from sdr_spoof.observations import Observations
    from sdr_spoof.pvt import PvtConfig
    from sdr_spoof.records import SatelliteVerdict, Verdict


def solve_trusted(
    seen: Observations, navigation: Navigation, config: PvtConfig, verdict: Verdict | None
) -> Fixes:
    """Fixes by ``config``, satellites under suspicion treated as ``config.suspects`` says."""
    distrusted = np.zeros(seen.spoofed.shape, np.bool_)
    if verdict is not None and config.suspects == "leave-out":
        distrusted = under_suspicion(seen, verdict)
    fixes = pvt.solve(seen, navigation, config, distrusted=distrusted)
    needed = distrusted.any(axis=1) & (fixes.status == Status.NO_FIX)
    if not needed.any():
        return fixes
    distrusted[needed] = False
    return pvt.solve(seen, navigation, config, distrusted=distrusted)


def under_suspicion(seen: Observations, verdict: Verdict) -> NDArray[np.bool_]:
    """Signals (E, S) of satellites that the verdict suspects, from their onset on, at epochs at
    which another satellite is spoofed; of those spoofed later, from the first one's onset on."""
    at_s = seen.sample_time_s
    onsets = [s.onset_s or 0.0 for s in verdict.satellites if s.verdict == SPOOFED]
    suspected = np.zeros(seen.spoofed.shape, np.bool_)
    for satellite in verdict.satellites:
        first_s = min(onsets, default=np.inf)
        if satellite.verdict == SPOOFED:
            since_s = first_s
        elif satellite.verdict == SUSPECT and _by_its_own_signals(satellite):
            since_s = max(satellite.onset_s or 0.0, first_s)
        else:
            continue
        own = [(s.system, s.prn) == (satellite.system, satellite.prn) for s in seen.signals]
        suspected[:, own] |= (at_s >= since_s)[:, None]
    return suspected


def _by_its_own_signals(satellite: SatelliteVerdict) -> bool:
    """Whether anything but what all satellites of a band share speaks against it."""
    alarms = satellite.alarms
    return not alarms or any(detectors.common_cause(a) is None for a in alarms)
