"""Which of the two bands was disturbed: the one whose own carrier left its extrapolation.

Each band's phase before the onset is fitted by a parabola (constant Doppler rate) and
extrapolated past it. The receiver's clock and motion move both bands alike (carrier scaled); an
attack on one band moves that one alone. Where both left, or neither significantly, the answer is
None: it cannot be told from the carriers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sdr_spoof.detectors.config import DetectionConfig
from sdr_spoof.detectors.phase_difference import phase_sigma_cycles
from sdr_spoof.records import ComboTrack, State

DOMINANCE = 3.0
"""The disturbed band must have left this many times further than the other."""
SIGNIFICANCE = 5.0
"""...and this many standard deviations of its own extrapolation."""
GUARD_S = 0.05
"""Signal just before the estimated onset that is left out of the fit, in s."""


def disturbed_band(
    track: ComboTrack, onset_s: float, alarm_s: float, config: DetectionConfig
) -> str | None:
    """Name of the signal that left its extrapolation between onset and alarm, or None."""
    usable = track.state >= State.SYNCED
    time = track.time_s
    before = usable & (time < onset_s - GUARD_S) & (time >= onset_s - config.attribution_fit_s)
    after = usable & (time >= onset_s) & (time <= alarm_s)
    if np.count_nonzero(before) < 20 or np.count_nonzero(after) < 3:
        return None
    upper, upper_sigma = _departure(
        time, track.phase_upper_cycles, track.cn0_upper_dbhz, before, after
    )
    lower, lower_sigma = _departure(
        time, track.phase_lower_cycles, track.cn0_lower_dbhz, before, after
    )
    if upper > max(SIGNIFICANCE * upper_sigma, DOMINANCE * lower):
        return track.upper
    if lower > max(SIGNIFICANCE * lower_sigma, DOMINANCE * upper):
        return track.lower
    return None


def _departure(
    time_s: NDArray[np.float64],
    phase_cycles: NDArray[np.float64],
    cn0_dbhz: NDArray[np.float64],
    before: NDArray[np.bool_],
    after: NDArray[np.bool_],
) -> tuple[float, float]:
    """Distance of the last third of ``after`` from the parabola, and its sigma, in cycles."""
    origin = float(time_s[before][-1])
    fitted = np.vander(time_s[before] - origin, 3)
    rows = np.flatnonzero(after)
    late = rows[-max(int(rows.size) // 3, 1) :]
    ahead = np.vander(time_s[late] - origin, 3).mean(axis=0)
    weights = ahead @ np.linalg.pinv(fitted)
    reference = phase_cycles[before][-1]
    # A departure shows at every row; its mean size must not cancel over a beat, so take rows one
    # by one for the size and the mean weights for the noise.
    predicted = np.vander(time_s[late] - origin, 3) @ (
        np.linalg.pinv(fitted) @ (phase_cycles[before] - reference)
    )
    size = float(np.sqrt(np.mean((phase_cycles[late] - reference - predicted) ** 2)))
    epoch_s = float(np.median(np.diff(time_s)))
    cn0_hz = 10.0 ** (float(np.median(cn0_dbhz[before])) / 10.0)
    sigma = float(phase_sigma_cycles(cn0_hz, epoch_s)) * float(
        np.hypot(1.0, np.linalg.norm(weights))
    )
    return size, sigma
