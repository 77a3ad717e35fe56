"""From increments and measurements to a solution: checks, and the call of the core."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof import _core
from sdr_spoof.errors import AidingError

from .config import TightConfig
from .solution import STATES, TESTS, Event, Smoothed, Start, TightSolution

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.imu.errors import ImuErrors
    from sdr_spoof.aiding.records import ImuLog, Measurements

    Floats = NDArray[np.float64]


def run(
    log: ImuLog,
    measurements: Measurements,
    start: Start,
    config: TightConfig | None = None,
) -> TightSolution:
    """Navigate one recording.

    Epochs before the start and after the end of the increments are not valid. Missing increments
    (gaps, NaN) are bridged with the rates before them and make attitude and velocity uncertain by
    0.05 rad and 1 m/s a second, four times that if longer than ``bridge_s``. Missing measurements
    are left out; with fewer than four satellites, or none, the INS goes on.

    Raises:
        AidingError: the times of both do not overlap, shapes do not fit, or the start lies outside.
    """
    one = (measurements.range_m[None], measurements.rate_m_s[None], measurements.change_m[None])
    return run_many(log, measurements, one, [start], config)[0]


def run_many(
    log: ImuLog,
    shared: Measurements,
    measured: tuple[Floats, Floats, Floats],
    starts: Sequence[Start],
    config: TightConfig | None = None,
    *,
    errors: Sequence[ImuErrors] | None = None,
    detailed: bool = True,
    threads: int = 1,
) -> list[TightSolution]:
    """Navigate R runs over the same increments and satellites.

    Args:
        log: increments of all runs.
        shared: epochs, satellites, C/N0 and flags of all runs.
        measured: ranges, rates and changes of the runs (R, E, S) each.
        starts: R states at the same time.
        config: of the filter.
        errors: of each run's IMU, added to the increments; None: they have theirs already.
        detailed: False leaves out what there is for each satellite.
        threads: runs side by side; the numbers do not depend on it.

    Raises:
        AidingError: as :func:`run`.
    """
    config = config or TightConfig()
    _check(log, shared, starts)
    rows = [[*s.position_m, *s.velocity_m_s, *s.attitude_rad] for s in starts]
    systems = {letter: k for k, letter in enumerate(dict.fromkeys(shared.systems))}
    made = _core.navigate_tight(
        np.ascontiguousarray(log.time_s),
        log.interval_s,
        np.ascontiguousarray(log.rotation_rad),
        np.ascontiguousarray(log.velocity_m_s),
        np.ascontiguousarray(shared.time_s),
        [systems[letter] for letter in shared.systems],
        np.ascontiguousarray(shared.satellite_m),
        np.ascontiguousarray(shared.satellite_velocity_m_s),
        np.ascontiguousarray(shared.cn0_dbhz),
        np.ascontiguousarray(shared.spoofed),
        np.ascontiguousarray(measured[0]),
        np.ascontiguousarray(measured[1]),
        np.ascontiguousarray(measured[2]),
        np.array(rows),
        starts[0].time_s,
        list(shared.lever_arm_m),
        config.core(),
        errors=None if errors is None else list(errors),
        detailed=detailed,
        threads=threads,
    )
    return [_solution(one, shared) for one in made]


def _check(log: ImuLog, shared: Measurements, starts: Sequence[Start]) -> None:
    if not log.time_s.size or not shared.time_s.size:
        raise AidingError("there are no increments or no epochs; give an IMU file that has some")
    if log.reference is not None and shared.reference is not None:
        apart = abs(float(log.reference - shared.reference))
        if apart > 1e-6:
            raise AidingError("increments and measurements count their times from other instants")
    first, last = log.time_s[0] - log.interval_s, log.time_s[-1]
    if shared.time_s[-1] < first or shared.time_s[0] > last:
        raise AidingError(
            f"increments ({first:.1f} to {last:.1f} s) and measurements ({shared.time_s[0]:.1f} to "
            f"{shared.time_s[-1]:.1f} s) do not overlap; check the time systems of both files"
        )
    start = starts[0].time_s
    if not first - 1e-6 <= start < last:
        raise AidingError(
            f"the start at {start:.1f} s lies outside the increments ({first:.1f} to {last:.1f} s)"
        )
    if np.any(np.diff(log.time_s) <= 0):
        raise AidingError("the times of the increments do not ascend; sort the IMU file by time")


def _solution(made: dict[str, Any], shared: Measurements) -> TightSolution:
    return TightSolution(
        reference=shared.reference,
        time_s=shared.time_s,
        satellites=shared.satellites,
        valid=made["valid"],
        position_m=made["position_m"],
        velocity_ned_m_s=made["velocity_ned"],
        attitude_rad=made["attitude_rad"],
        covariance=made["covariance"],
        clock_m=made["clock"][:, 0],
        drift_m_s=made["clock"][:, 1],
        gyro_bias_rad_s=made["bias"][:, :3],
        accelerometer_bias_m_s2=made["bias"][:, 3:],
        range_innovation_m=made["range"][..., 0],
        range_sigma_m=made["range"][..., 1],
        rate_innovation_m_s=made["rate"][..., 0],
        rate_sigma_m_s=made["rate"][..., 1],
        usage=made["usage"],
        solution_statistic=made["solution_statistic"],
        channel_statistic=made["channel_statistic"],
        threat=made["threat"],
        severity=made["severity"],
        deviates=made["deviates"],
        state=made["state"],
        events=tuple(_event(e, shared.satellites) for e in made["events"]),
        apart_m=made["apart"] if made["apart"].size else None,
        smoothed=None if made["smoothed"] is None else _smoothed(made["smoothed"]),
    )


def _smoothed(made: dict[str, Any]) -> Smoothed:
    return Smoothed(
        position_m=made["position_m"],
        velocity_ned_m_s=made["velocity_ned"],
        attitude_rad=made["attitude_rad"],
        covariance=made["covariance"],
    )


def _event(values: tuple[Any, ...], satellites: tuple[str, ...]) -> Event:
    time_s, state, test, deviate, mask, back_s, apart_m = values
    return Event(
        time_s=time_s,
        state=STATES[state],
        test=TESTS[test] if test >= 0 else "",
        deviate=deviate,
        excluded=tuple(s for k, s in enumerate(satellites) if mask >> k & 1),
        back_s=back_s,
        apart_m=apart_m,
    )
