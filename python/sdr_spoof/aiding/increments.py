"""Increments of an IMU made fit for navigation: checked, from rates, gaps bridged."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import InertialError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, radians
from sdr_spoof.scenario.sky.trajectory import rotations

from .records import ImuLog, InertialStates

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime

RATES_HZ = (50.0, 400.0)
"""Slower, coning and sculling are lost; faster is not needed and not tested."""
EARTH_RATE_RAD_S = 7.292115e-5
"""NIMA TR8350.2, table 3.1."""
BRIDGE_S = 0.1
"""Longest gap that is bridged unless told otherwise."""
_LATE = 0.5
"""Parts of an interval by which an increment may come late before one is missing."""


@dataclass(frozen=True)
class Gap:
    """Increments are missing."""

    start_s: float
    """End of the last increment before it."""
    end_s: float
    """Start of the first increment after it."""

    @property
    def length_s(self) -> float:
        """How long nothing was sensed."""
        return self.end_s - self.start_s


def check(log: ImuLog) -> None:
    """Refuses a log that cannot be navigated with.

    Raises:
        InertialError: wrong shapes, a rate outside 50 to 400 Hz, numbers that are not finite, or
            times that do not ascend.
    """
    rows = log.time_s.shape[0] if log.time_s.ndim == 1 else -1
    for name in ("rotation_rad", "velocity_m_s"):
        shape = getattr(log, name).shape
        if shape != (rows, 3) or rows < 1:
            raise InertialError(
                f"{name} has shape {shape} beside time_s of {log.time_s.shape}: give (N, 3) and "
                "(N,), with at least one increment"
            )
    rate_hz = 1 / log.interval_s if log.interval_s > 0 else np.nan
    low, high = RATES_HZ
    if not low * 0.99 <= rate_hz <= high * 1.01:
        raise InertialError(
            f"the IMU's interval of {log.interval_s:g} s is outside {low:g} to {high:g} Hz: sum "
            "faster increments up before, and do not navigate with slower ones"
        )
    _check_values(log)


def _check_values(log: ImuLog) -> None:
    for name in ("time_s", "rotation_rad", "velocity_m_s"):
        values = getattr(log, name)
        bad = np.flatnonzero(~np.isfinite(values.reshape(len(values), -1)).all(axis=1))
        if bad.size:
            raise InertialError(
                f"{name} is not a number in {bad.size} of {len(values)} rows, first in row "
                f"{bad[0]}: leave such rows out, they are then treated as a gap"
            )
    steps = np.diff(log.time_s)
    if steps.size and steps.min() <= 0:
        row = int(np.argmax(steps <= 0)) + 1
        raise InertialError(
            f"the time of row {row} of the IMU, {log.time_s[row]:.6f} s, is not after that of the "
            f"row before, {log.time_s[row - 1]:.6f} s: sort the rows, or split the log where its "
            "clock was set back"
        )


def gaps(log: ImuLog) -> list[Gap]:
    """Where more than half an increment is missing."""
    steps = np.diff(log.time_s)
    rows = np.flatnonzero(steps > (1 + _LATE) * log.interval_s)
    return [Gap(float(log.time_s[r]), float(log.time_s[r + 1]) - log.interval_s) for r in rows]


def intervals_s(log: ImuLog) -> NDArray[np.float64]:
    """What each increment covers: the time since the one before, the nominal interval after a gap
    and at the beginning, (N,)."""
    steps = np.diff(log.time_s, prepend=log.time_s[0] - log.interval_s)
    late = steps > (1 + _LATE) * log.interval_s
    return np.asarray(np.where(late, log.interval_s, steps))


def bridged(log: ImuLog, longest_s: float = BRIDGE_S) -> ImuLog:
    """The log with increments put into gaps, on a straight line between their neighbours.

    A gap of g seconds in which the acceleration changes by a beside that line costs about a g / 2
    of velocity; longer gaps are left as they are.

    Args:
        log: Checked.
        longest_s: Gaps up to here are bridged.
    """
    bridges = [_bridge(log, gap) for gap in gaps(log) if gap.length_s <= longest_s]
    if not bridges:
        return log
    parts = [log, *bridges]
    time_s = np.concatenate([part.time_s for part in parts])
    order = np.argsort(time_s, kind="stable")
    return replace(
        log,
        time_s=time_s[order],
        rotation_rad=np.concatenate([part.rotation_rad for part in parts])[order],
        velocity_m_s=np.concatenate([part.velocity_m_s for part in parts])[order],
    )


def _bridge(log: ImuLog, gap: Gap) -> ImuLog:
    """What is put into one gap."""
    after = int(np.searchsorted(log.time_s, gap.start_s, side="right"))
    count = max(round(gap.length_s / log.interval_s), 1)
    length_s = gap.length_s / count
    middles_s = (np.arange(count) + 0.5) * length_s + 0.5 * log.interval_s
    share = (middles_s / (gap.length_s + log.interval_s))[:, None]
    scale = length_s / intervals_s(log)[after - 1 : after + 1]

    def between(values: NDArray[np.float64]) -> NDArray[np.float64]:
        first, last = values[after - 1] * scale[0], values[after] * scale[1]
        return np.asarray(first + (last - first) * share)

    ends_s = gap.start_s + length_s * np.arange(1.0, count + 1)
    return replace(
        log,
        time_s=ends_s,
        rotation_rad=between(log.rotation_rad),
        velocity_m_s=between(log.velocity_m_s),
    )


def from_rates(
    time_s: NDArray[np.float64],
    rate_rad_s: NDArray[np.float64],
    force_m_s2: NDArray[np.float64],
    *,
    reference: GnssTime | None = None,
) -> ImuLog:
    """Increments from samples of angular rate and specific force.

    Each interval between two samples is integrated under the cubic through the four samples about
    it (under the parabola at the ends), which leaves an error of the fifth order.

    Args:
        time_s: Equally spaced to a part in 100, (N,), N >= 4.
        rate_rad_s: Against inertial space, body axes, (N, 3).
        force_m_s2: Likewise, (N, 3).
        reference: What the times count from.

    Returns:
        N - 1 increments.

    Raises:
        InertialError: what :func:`check` raises, too few samples, or unequal spacing.
    """
    steps = np.diff(time_s)
    if len(time_s) < 4:
        raise InertialError(f"{len(time_s)} samples of rates are too few: give at least 4")
    interval_s = float(np.median(steps))
    log = ImuLog(reference, time_s, interval_s, rate_rad_s, force_m_s2)
    check(log)
    if np.abs(steps - interval_s).max() > 0.01 * interval_s:
        row = int(np.argmax(np.abs(steps - interval_s)))
        raise InertialError(
            f"samples of rates must be equally spaced: {interval_s:g} s as a rule, but "
            f"{steps[row]:g} s after row {row}; split the log there or resample it"
        )
    return replace(
        log,
        time_s=time_s[1:],
        rotation_rad=interval_s * _means(rate_rad_s),
        velocity_m_s=interval_s * _means(force_m_s2),
    )


def _means(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean between neighbours (N - 1, 3) under cubics through (N, 3)."""
    means = np.empty((len(values) - 1, 3))
    means[1:-1] = (13 * (values[1:-2] + values[2:-1]) - values[:-3] - values[3:]) / 24
    means[0] = (5 * values[0] + 8 * values[1] - values[2]) / 12
    means[-1] = (5 * values[-1] + 8 * values[-2] - values[-3]) / 12
    return means


def at_rest(start: InertialStates, duration_s: float, rate_hz: float = 100.0) -> ImuLog:
    """Increments of a perfect IMU that stands still: Earth rate and normal gravity.

    Args:
        start: Where, how turned, and from when on, one row; its velocity is not looked at.
        duration_s: Length.
        rate_hz: Rate of the increments.
    """
    count, interval_s = round(duration_s * rate_hz), 1 / rate_hz
    latitude, _, height_m = radians(ecef_to_geodetic(start.position_m[:1]))[0]
    gravity = _core.normal_gravity(np.array([latitude]), np.array([height_m]))[0]
    turn = EARTH_RATE_RAD_S * np.array([np.cos(latitude), 0.0, -np.sin(latitude)])
    into_body = rotations(start.attitude_rad[:1])[0].T
    return ImuLog(
        start.reference,
        start.time_s[0] + interval_s * np.arange(1, count + 1),
        interval_s,
        np.tile(into_body @ turn * interval_s, (count, 1)),
        np.tile(into_body @ [0.0, 0.0, -gravity * interval_s], (count, 1)),
    )
