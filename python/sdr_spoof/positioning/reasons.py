"""Why satellites were left out, and why there is no fix, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.fixes import CAUSES, Cause

if TYPE_CHECKING:
    from sdr_spoof.fixes import Fixes

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
