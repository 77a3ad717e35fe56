"""What the detectors say, carried over to the observations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sdr_spoof.fusion import SPOOFED

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sdr_spoof.observations import ObservedSignal
    from sdr_spoof.records import Verdict


def mark_spoofed(
    flags: NDArray[np.bool_],
    signal: ObservedSignal,
    sample_time_s: NDArray[np.float64],
    verdict: Verdict,
    *,
    trust_fallback: bool,
) -> None:
    """Flag a column from the onset of its satellite's spoofing on."""
    for satellite in verdict.satellites:
        if (satellite.system, satellite.prn) != (signal.system, signal.prn):
            continue
        if satellite.verdict != SPOOFED:
            continue
        if trust_fallback and satellite.fallback == signal.signal:
            continue
        flags |= sample_time_s >= (satellite.onset_s or 0.0)
