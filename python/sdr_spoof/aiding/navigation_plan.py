"""What a strapdown run is made of, checked: increments from the start on, alignments, heights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from sdr_spoof.errors import InertialError

from . import increments
from .records import ImuLog, InertialStates

if TYPE_CHECKING:
    from numpy.typing import NDArray

Mechanisation = Literal["local", "earth-fixed"]
"""They agree to rounding; near the poles only the second works."""
Altimeter = tuple["NDArray[np.float64]", "NDArray[np.float64]"]
"""Times (K,) and heights above the ellipsoid in m (K,)."""
_NEAR_POLE_DEG = 89.5
_MEAN_RADIUS_M = 6.37e6
_RADIUS_RANGE_M = 1e5
_LATE = 0.51
"""Parts of an interval by which times of alignments and of increments may differ."""


@dataclass(frozen=True)
class Plan:
    """What the core is asked for."""

    log: ImuLog
    """From the start on, bridged."""
    interval_s: NDArray[np.float64]
    """What each increment covers."""
    start: InertialStates
    realign: InertialStates | None
    after: list[tuple[int, bool]]
    """Increments before each new alignment, and whether a gap follows them."""
    vertical: NDArray[np.float64] | None
    """Height and velocity downwards after each increment, (N, 2)."""
    every: int
    mechanisation: Mechanisation

    def arrays(self) -> tuple[NDArray[np.float64], ...]:
        """Rotations and velocities (N, 3), intervals (N,), and the start (9,)."""
        return (
            np.ascontiguousarray(self.log.rotation_rad),
            np.ascontiguousarray(self.log.velocity_m_s),
            self.interval_s,
            rows(self.start)[0],
        )

    def output_s(self) -> NDArray[np.float64]:
        """Times of the output: the start, and after each ``every`` increments, (M,)."""
        after = self.log.time_s[self.every - 1 :: self.every]
        return np.concatenate([self.start.time_s, after])

    def aligned_s(self) -> NDArray[np.float64]:
        """Seconds since the last alignment at these times, (M,)."""
        time_s = self.output_s()
        first_s = self.start.time_s - self.start.aligned_s
        alignments_s = np.concatenate(
            [first_s, [] if self.realign is None else self.realign.time_s]
        )
        before = [number + 0.5 * gap for number, gap in self.after]
        last = np.searchsorted(before, self.every * np.arange(len(time_s)), side="right")
        return np.asarray(np.maximum(time_s - alignments_s[last], 0.0))


def plan(
    log: ImuLog,
    start: InertialStates,
    *,
    every: int,
    realign: InertialStates | None = None,
    altimeter: Altimeter | None = None,
    mechanisation: Mechanisation = "local",
    bridge_s: float = increments.BRIDGE_S,
) -> Plan:
    """Checks everything and brings it together; see :func:`strapdown.navigate`."""
    increments.check(log)
    _check_states(log, start, mechanisation, "start")
    if len(start.time_s) != 1:
        raise InertialError(f"the start has {len(start.time_s)} rows: give one (strapdown.row)")
    if every < 1:
        raise InertialError(f"a row each {every} increments: give 1 or more")
    log, interval_s = _from(increments.bridged(log, bridge_s), float(start.time_s[0]))
    after = [] if realign is None else _after(log, realign, mechanisation)
    _check_gaps(log, [] if realign is None else list(realign.time_s), bridge_s)
    vertical = None if altimeter is None else _vertical(log.time_s, interval_s, altimeter)
    return Plan(log, interval_s, start, realign, after, vertical, every, mechanisation)


def rows(states: InertialStates) -> NDArray[np.float64]:
    """Position, velocity, attitude side by side, (M, 9)."""
    return np.hstack([states.position_m, states.velocity_m_s, states.attitude_rad])


def _check_states(
    log: ImuLog, states: InertialStates, mechanisation: Mechanisation, name: str
) -> None:
    values = rows(states)
    if not np.isfinite(values).all() or not np.isfinite(states.time_s).all():
        raise InertialError(f"a state of the {name} is not a number: give a complete one")
    if None not in (log.reference, states.reference) and log.reference != states.reference:
        raise InertialError(
            f"times of the IMU and of the {name} count from different instants: bring both to one"
        )
    radius_m = np.linalg.norm(values[:, :3], axis=1)
    if (np.abs(radius_m - _MEAN_RADIUS_M) > _RADIUS_RANGE_M).any():
        raise InertialError(
            f"the position of the {name} is {radius_m[0]:.0f} m from the Earth's centre: give "
            "Earth-fixed coordinates in m, not latitude and longitude"
        )
    limit = np.sin(np.radians(_NEAR_POLE_DEG))
    if mechanisation == "local" and (np.abs(values[:, 2]) > limit * radius_m).any():
        raise InertialError("local axes turn without bound at the poles: use earth-fixed ones")


def _from(log: ImuLog, start_s: float) -> tuple[ImuLog, NDArray[np.float64]]:
    """Increments after the start and their intervals, the first cut to begin there."""
    first = int(np.searchsorted(log.time_s, start_s + 0.5 * log.interval_s, side="right"))
    if first == len(log.time_s):
        raise InertialError(
            f"the IMU ends at {log.time_s[-1]:.3f} s, before the start at {start_s:.3f} s: do the "
            "clocks of both agree?"
        )
    interval_s = increments.intervals_s(log)[first:]
    early_s = float(log.time_s[first]) - interval_s[0] - start_s
    if abs(early_s) > _LATE * log.interval_s:
        raise InertialError(
            f"the first increment begins {early_s:.3f} s after the start at {start_s:.3f} s: align "
            "where the IMU has begun, and not within a gap"
        )
    share = np.ones((len(interval_s), 1))
    share[0] = (log.time_s[first] - start_s) / interval_s[0]
    cut = ImuLog(
        log.reference,
        log.time_s[first:],
        log.interval_s,
        log.rotation_rad[first:] * share,
        log.velocity_m_s[first:] * share,
    )
    return cut, interval_s * share[:, 0]


def _after(
    log: ImuLog, realign: InertialStates, mechanisation: Mechanisation
) -> list[tuple[int, bool]]:
    """How many increments have passed at each new alignment, and whether a gap follows."""
    _check_states(log, realign, mechanisation, "new alignment")
    times = realign.time_s
    if (np.diff(times) <= 0).any():
        raise InertialError("times of new alignments must ascend: sort them")
    after = np.searchsorted(log.time_s, times + 0.5 * log.interval_s, side="right")
    if (after == 0).any() or (times > log.time_s[-1] + 0.5 * log.interval_s).any():
        raise InertialError(
            f"a new alignment at {times[0]:.3f} to {times[-1]:.3f} s lies outside the increments, "
            f"which end at {log.time_s[0]:.3f} to {log.time_s[-1]:.3f} s"
        )
    gap = times - log.time_s[after - 1] > _LATE * log.interval_s
    return [(int(n), bool(g)) for n, g in zip(after, gap, strict=True)]


def _check_gaps(log: ImuLog, aligned_s: list[float], bridge_s: float) -> None:
    """Each gap that is left must end where a new alignment is."""
    for gap in increments.gaps(log):
        near = [abs(t - gap.end_s) <= _LATE * log.interval_s for t in aligned_s]
        if not any(near):
            raise InertialError(
                f"the IMU misses {gap.length_s:.3f} s at {gap.start_s:.3f} s, more than the "
                f"{bridge_s:g} s that are bridged: align anew at {gap.end_s:.3f} s, or raise "
                "bridge_s where the motion is steady"
            )


def _vertical(
    time_s: NDArray[np.float64], interval_s: NDArray[np.float64], altimeter: Altimeter
) -> NDArray[np.float64]:
    """Height, and velocity downwards, at the end of each increment, (N, 2)."""
    at_s, height_m = altimeter
    if at_s[0] > time_s[0] or at_s[-1] < time_s[-1] - interval_s[-1]:
        raise InertialError(
            f"the altimeter knows heights from {at_s[0]:.2f} to {at_s[-1]:.2f} s, the IMU runs "
            f"from {time_s[0]:.2f} to {time_s[-1]:.2f} s: give heights for all of it"
        )
    heights = np.interp(time_s, at_s, height_m)
    down = -np.gradient(heights, time_s) if len(time_s) > 1 else np.zeros(1)
    return np.column_stack([heights, down])
