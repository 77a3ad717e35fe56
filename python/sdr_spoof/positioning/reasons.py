"""Why satellites were left out, why there is no fix, and what fixes lack, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.fixes import CAUSES, Cause
from sdr_spoof.nav.store import Store
from sdr_spoof.pvt.models import ionosphere

if TYPE_CHECKING:
    from sdr_spoof.fixes import Fixes
    from sdr_spoof.nav.broadcast import Contents
    from sdr_spoof.pvt import PvtConfig

UNTOLD = (Cause.LOW, Cause.NO_FIX, Cause.NOT_WANTED)


def left_out(fixes: Fixes) -> list[str]:
    """Satellites left out of any epoch, by cause, a sentence each."""
    names: dict[Cause, dict[str, None]] = {}
    for e in fixes.excluded:
        if e.cause not in UNTOLD:
            names.setdefault(e.cause, {})[e.satellite] = None
    return [f"{CAUSES[cause]}: {', '.join(found)}" for cause, found in names.items()]


def reasons(fixes: Fixes) -> list[str]:
    """Those, and what is missing where no epoch has a fix."""
    told = left_out(fixes)
    if fixes.epochs and not fixes.fixed.any():
        hint = ""
        if (fixes.cause == Cause.NO_EPHEMERIS).any():
            hint = "; a navigation file would tell the orbits that were not received in full"
        told.append(f"no fix: {fixes.reason(fixes.epochs - 1)}{hint}")
    return told


def unmodelled(fixes: Fixes, navigation: Contents, config: PvtConfig) -> list[str]:
    """That an ionosphere is wanted whose parameters nobody told."""
    if config.ionosphere == "none" or not fixes.fixed.any():
        return []
    store, at = Store(navigation), fixes.time(int(np.flatnonzero(fixes.fixed)[0]))
    models = [ionosphere(config, system, store, at) for system in fixes.systems]
    if not any(m is None or m.blank for m in models):
        return []
    return [
        "the parameters of the ionosphere were not received, or are all zero: heights may be 10 m "
        "off and more; a navigation file would tell them"
    ]
