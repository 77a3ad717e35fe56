"""Whether IMU and GNSS tell of one motion before anybody may be accused.

A lever arm or a clock that is wrong, axes, units, a wrong attitude at the start: for the filter all
of them are GNSS that leaves the INS, which is what spoofers do. They differ in time: they are there
from the beginning, or from a jump of the IMU's clock on, which looks like a gap. So a free INS is
started there, and what it and the phases say is compared up to the first alarm (:mod:`.swing`), and
by ``rate_drag`` in the first seconds. It is no test for spoofing: an attack that is there from
the beginning cannot be told from an IMU that is wrong, and the words say so.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import decision
from sdr_spoof.aiding.detectors import rate_drag
from sdr_spoof.aiding.detectors.changes import changes
from sdr_spoof.aiding.imu.grades import GRAVITY_M_S2
from sdr_spoof.aiding.increments import BRIDGE_S, gaps
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.aiding.strapdown import navigate
from sdr_spoof.decision import Decision

from .swing import VAGUE_M, swing

if TYPE_CHECKING:
    from sdr_spoof.aiding.detectors.changes import Changes
    from sdr_spoof.aiding.records import ImuLog, Measurements
    from sdr_spoof.config import Config

    from .swing import Swing

LONGEST_S = 300.0
"""More adds nothing."""
LEAST_S = 5.0
EARLY_S = 25.0
"""What does not fit at all shows so soon; what shows later may be an attack."""
STATES_HZ = 10.0
TILT_S, LEAST_TILT_DEG, TILT_SIGMAS = 20.0, 0.25, 5.0
"""A tilt of the start bends the way of an INS by a quarter of g t^2 tilt in so long."""


def last_gap_s(log: ImuLog, until_s: float) -> float | None:
    """Where the last gap before a time ends that is too long to be bridged; None: there is none."""
    ends = [g.end_s for g in gaps(log) if g.length_s > BRIDGE_S and g.end_s < until_s]
    return ends[-1] if ends else None


def doubt(
    log: ImuLog,
    measurements: Measurements,
    begin: InertialStates,
    until_s: float,
    config: Config,
) -> str:
    """What does not fit from ``begin`` on, in a sentence; empty if all does, or nothing is told.

    Args:
        log: increments by the clock of the measurements.
        measurements: of the receiver.
        begin: state to navigate from, one row.
        until_s: first alarm, or the end.
        config: its groups ``rate``, with the errors of that state, and ``tight``.

    Raises:
        ConfigError: there is no such grade of IMU.
    """
    begin_s = float(begin.time_s[0])
    until_s = min(until_s, begin_s + LONGEST_S, *_next_gap(log, begin_s))
    log = log.part(0, int(np.searchsorted(log.time_s, until_s, side="right")))
    if until_s - begin_s < LEAST_S or not log.time_s.size or log.time_s[-1] - begin_s < LEAST_S:
        return ""
    free = navigate(log, begin, every=max(1, round(1 / (STATES_HZ * log.interval_s))))
    rows = np.searchsorted(measurements.time_s, [begin_s - 1e-6, free.time_s[-1] + 1e-6])
    seen = measurements.part(int(rows[0]), int(rows[1]))
    if seen.time_s.size < LEAST_S:
        return ""
    found = swing(seen, free, config.rate)
    if found is not None and (found.arm_wrong or found.clock_wrong):
        return _words(found)
    tilt_deg = _tilt_deg(changes(seen, free, config.rate))
    if tilt_deg > max(TILT_SIGMAS * config.rate.align_level_deg, LEAST_TILT_DEG):
        return (
            f"roll and pitch at {begin_s:.0f} s seem to be off by {tilt_deg:.1f} degrees, as GNSS "
            f"moves in the next {TILT_S:g} s: alarms may come of that; check attitude, axes and "
            "units of the IMU"
        )
    early = int(np.searchsorted(seen.time_s, begin_s + min(EARLY_S, config.tight.settle_s)))
    return _from_the_beginning(seen.part(0, early), free, config)


def _next_gap(log: ImuLog, begin_s: float) -> list[float]:
    return [g.start_s for g in gaps(log) if g.length_s > BRIDGE_S and g.start_s > begin_s][:1]


def _words(found: Swing) -> str:
    if found.clock_wrong and found.clock_share > found.arm_share:
        off = f"{found.clock_s:+.2f} ± {found.clock_sigma_s:.2f} s"
        return (
            f"the IMU's clock seems to be off by {off} against GNSS, or in another time system: "
            "alarms may come of that; give --imu-clock-offset-s"
        )
    arm = ", ".join(
        f"{v:.1f} ± {s:.1f}" if s < VAGUE_M else "?"
        for v, s in zip(found.arm_m, found.arm_sigma_m, strict=True)
    )
    given = ",".join(f"{v:g}" for v in found.given_m)
    return (
        f"the antenna swings about the IMU as at {arm} m (forward, right, down), not as at the "
        f"lever arm of {given} m: alarms may come of that; give --lever-arm as measured"
    )


def _tilt_deg(found: Changes) -> float:
    """Tilt that would accelerate the INS as the first seconds have it; 0 where none is told."""
    since_s = found.time_s - found.time_s[0]
    rows = since_s <= TILT_S + 1e-6
    if since_s[-1] < TILT_S or (found.segment[rows][1:] != found.segment[1]).any():
        return 0.0
    way = np.cumsum(np.nan_to_num(found.displacement_m[rows, :2]), axis=0)
    half = way[int(np.searchsorted(since_s, TILT_S / 2))]
    bent = way[-1] - 2 * half
    return float(np.degrees(np.linalg.norm(bent) * 4 / TILT_S**2 / GRAVITY_M_S2))


def _from_the_beginning(seen: Measurements, free: InertialStates, config: Config) -> str:
    if seen.time_s.size < LEAST_S:
        return ""
    for series in rate_drag.statistics(seen, free, config):
        decided = decision.decide(series, config.detection) if series.time_s.size else None
        if isinstance(decided, Decision):
            return (
                f"IMU and GNSS tell of different motions already at {decided.alarm_s:.0f} s, "
                "before anything could be judged: check attitude, axes, units, lever arm and clock "
                "of the IMU; or an attack was there from the beginning"
            )
    return ""
