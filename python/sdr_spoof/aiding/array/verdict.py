"""What the tests of one signal on an array amount to, and why, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

SPOOFED, CLEAN, NO_SUPPORT = "spoofed", "clean", "not enough support"
Said = tuple[float | None, str]
"""Time of the alarm, and a reason; no reason where nothing was tested."""


def moved(time_s: Floats, way_m: Floats, score: Floats, threshold: float) -> Said:
    """What T tests of motion say."""
    if not time_s.size:
        return None, ""
    over = np.flatnonzero(score > threshold)
    largest = _largest(score, threshold)
    if not over.size:
        return None, f"its direction is a satellite's over up to {way_m.max():.0f} m; {largest}"
    at_s = float(time_s[over[0]])
    return at_s, f"at {at_s:.1f} s its direction had moved as that of a source near by; {largest}"


def arrived(time_s: Floats, score: Floats, threshold: float) -> Said:
    """What T directions of arrival say."""
    over = np.flatnonzero(score > threshold)
    largest = _largest(score, threshold)
    if not over.size:
        return None, f"it comes from where the satellite is; {largest}"
    at_s = float(time_s[over[0]])
    return at_s, f"at {at_s:.1f} s it did not come from where the satellite is; {largest}"


def of(said: Sequence[Said], least_way_m: float) -> tuple[str, str]:
    """The verdict, and the reason for it."""
    alarmed = [reason for _, reason in sorted((at_s, r) for at_s, r in said if at_s is not None)]
    tested = [reason for _, reason in said if reason]
    if alarmed:
        return SPOOFED, "; ".join(alarmed)
    if tested:
        return CLEAN, "; ".join(tested)
    return NO_SUPPORT, f"no unbroken phases over {least_way_m:g} m of motion on all antennas"


def _largest(score: Floats, threshold: float) -> str:
    return f"at most {float(score.max()):.1f} sigma against {threshold:.1f}"
