"""From measurements and increments to places, alarms and a verdict.

The filter runs first; the free INS, whose rates are compared with those of carrier phase, starts
from what it knows (:mod:`.free`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.imu.grades import DEG_HOUR, DEG_ROOT_HOUR, MICRO_G, named
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.aiding.tight import run as run_filter
from sdr_spoof.aiding.tight.solution import FLOOR
from sdr_spoof.errors import AidingError
from sdr_spoof.progress import silent
from sdr_spoof.scenario.sky.clock import ALLAN
from sdr_spoof.signals import LIGHT_M_S

from . import agreement, free
from .clocks import on_one_clock
from .filtered import monitors_of, published_of, three_way, track_of
from .judge import doubted, judge
from .start import begin

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sdr_spoof.aiding.error_growth import AlignmentSigma
    from sdr_spoof.aiding.records import ImuLog, Measurements
    from sdr_spoof.aiding.tight import Start, TightConfig, TightSolution
    from sdr_spoof.config import Config
    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.progress import Stages

    from .judge import AidedVerdict
    from .records import AidedTrack, Monitor

LEAST_CLOCK_M2_S, LEAST_DRIFT_M2_S3 = 1e-3, 1e-6
"""Of even the best oscillator: what is left of the model's own error."""


@dataclass(frozen=True)
class Aided:
    """All that aiding found."""

    verdict: AidedVerdict
    measurements: Measurements
    inertial: InertialStates | None
    """The INS by itself."""
    track: AidedTrack | None
    """The filter; None where it could not run."""
    monitors: tuple[Monitor, ...]
    """Tests of the filter and of rates, with thresholds and alarms."""
    residuals: tuple[Monitor, ...]
    """Rates left over, east, north, up."""
    risk: float
    """Probability that an error exceeds its protection level."""
    published: tuple[Monitor, ...] = ()
    """The R statistics."""
    story: tuple[str, ...] = ()
    """What the filter did, a sentence an event."""
    three_way: str = ""
    """The published verdict, in words."""

    @property
    def reference(self) -> GnssTime:
        """What times count from."""
        if self.measurements.reference is None:
            raise AidingError("the measurements know no GNSS time; give files that do")
        return self.measurements.reference

    @property
    def span_s(self) -> tuple[float, float]:
        """First and last epoch."""
        times = self.measurements.time_s
        return float(times[0]), float(times[-1])

    @property
    def satellites(self) -> int:
        """How many were measured."""
        return len(self.measurements.satellites)


def aid(
    measurements: Measurements,
    log: ImuLog,
    config: Config,
    stages: Stages = silent,
    notes: Sequence[str] = (),
) -> Aided:
    """Filter, compare, judge.

    Args:
        measurements: of the receiver.
        log: increments, by GNSS time.
        config: its groups ``aided``, ``tight``, ``rate`` and ``detection``.
        stages: shows progress.
        notes: what the files said, for the verdict.

    Raises:
        AidingError: IMU and GNSS do not overlap, or there is nothing to start with.
        InertialError: the increments are unusable.
        ConfigError: a wrong name in the configuration.
    """
    config = with_hardware(config)
    log = on_one_clock(log, measurements)
    with stages("Aligning"):
        beginning = begin(log, measurements, config)
        config = _with_sigma(config, beginning.sigma)
    with stages("Filtering"):
        solution = run_filter(log, measurements, beginning.start, config.tight)
        track = track_of(solution, measurements, config.aided.integrity_risk)
        tests = monitors_of(solution, config.tight)
    with stages("Testing rates"):
        inertial, rates = free.rates(log, measurements, solution, config)
    verdict = judge(
        track,
        (*tests, *rates.monitors),
        (*notes, *rates.notes),
        " ".join((FLOOR, *rates.limits)),
        rates.tests + float(np.isfinite(solution.deviates).sum()),
        config.aided.min_tested_s,
        [name for e in solution.events if e.state == "partial" for name in e.excluded],
    )
    why = _doubt(log, measurements, solution, beginning.start, verdict.alarm_s, config)
    verdict = doubted(verdict, why) if why else verdict
    return Aided(
        verdict,
        measurements,
        inertial,
        track,
        (*tests, *rates.monitors),
        rates.residuals,
        config.aided.integrity_risk,
        published_of(solution, config.tight),
        (
            f"{beginning.start.time_s:.1f} s: begins; alignment {beginning.method}",
            *(f"{e.time_s:.1f} s: {e.words()}" for e in solution.events),
        ),
        three_way(solution, config.tight),
    )


def with_hardware(config: Config) -> Config:
    """The configuration with the noise of a named IMU and oscillator, where it says none itself.

    White frequency noise h0 makes the clock's offset walk by c^2 h0 / 2, random-walk noise h-2 its
    drift by 2 pi^2 c^2 h-2 (see :mod:`sdr_spoof.scenario.sky.clock`).

    Raises:
        ConfigError: there is no such grade.
    """
    noise, rate = {}, config.rate
    if config.aided.oscillator:
        h0, _, h_2 = ALLAN[config.aided.oscillator]
        noise["clock_m2_s"] = max(0.5 * LIGHT_M_S**2 * h0, LEAST_CLOCK_M2_S)
        noise["clock_drift_m2_s3"] = max(2 * (math.pi * LIGHT_M_S) ** 2 * h_2, LEAST_DRIFT_M2_S3)
    if config.aided.grade:
        grade = named(config.aided.grade)
        gyro, force = grade.gyro, grade.accelerometer
        noise["gyro_bias_deg_h"] = math.hypot(gyro.bias, gyro.wander) / DEG_HOUR
        noise["gyro_walk_deg_sqrt_h"] = gyro.density / DEG_ROOT_HOUR
        noise["accelerometer_bias_ug"] = math.hypot(force.bias, force.wander) / MICRO_G
        noise["accelerometer_walk_ug_sqrt_hz"] = force.density / MICRO_G
        rate = rate.model_copy(update={"grade": grade.name})
    return config.model_copy(update={"tight": _unless_given(config.tight, noise), "rate": rate})


def _unless_given(tight: TightConfig, update: dict[str, float]) -> TightConfig:
    """What the configuration says itself stays."""
    own = tight.model_fields_set
    return tight.model_copy(update={k: v for k, v in update.items() if k not in own})


def _with_sigma(config: Config, sigma: AlignmentSigma | None) -> Config:
    """The configuration with what an alignment says of its errors, where none is given."""
    if sigma is None:
        return config
    found = {
        "start_position_m": max(sigma.position_m),
        "start_velocity_m_s": max(sigma.velocity_m_s),
        "start_level_deg": math.degrees(max(sigma.attitude_rad[:2])),
        "start_heading_deg": math.degrees(sigma.attitude_rad[2]),
    }
    update = {name: max(v, 1e-3) for name, v in found.items()}
    return config.model_copy(update={"tight": _unless_given(config.tight, update)})


def _doubt(
    log: ImuLog,
    measurements: Measurements,
    solution: TightSolution,
    start: Start,
    alarm_s: float | None,
    config: Config,
) -> str:
    """What does not fit from the start on, or after the last gap of the IMU before the alarm."""
    until_s = math.inf if alarm_s is None else alarm_s
    gap_s = agreement.last_gap_s(log, until_s)
    if gap_s is not None:
        why = _doubt_after_gap(log, measurements, solution, gap_s, until_s, config)
        if why:
            return why
    return agreement.doubt(
        log, measurements, _first(log, start), until_s, _aligned_at_start(config)
    )


def _doubt_after_gap(
    log: ImuLog,
    measurements: Measurements,
    solution: TightSolution,
    gap_s: float,
    until_s: float,
    config: Config,
) -> str:
    row = int(np.searchsorted(solution.time_s, gap_s + log.interval_s))
    if row < solution.time_s.size and solution.valid[row] and solution.time_s[row] < until_s:
        begin, known = free.state_of(log, solution, row), free.aligned(config, solution, row)
        why = agreement.doubt(log, measurements, begin, until_s, known)
        if why:
            return f"after the gap of the IMU at {gap_s:.1f} s {why}"
    if until_s < gap_s + config.tight.settle_s:
        return (
            f"the alarm at {until_s:.1f} s comes soon after a gap of the IMU at {gap_s:.1f} s: has "
            "its clock jumped there? Split the file there"
        )
    return ""


def _aligned_at_start(config: Config) -> Config:
    """What the filter believes of its start, where ``[rate]`` says nothing."""
    tight, own = config.tight, config.rate.model_fields_set
    known = {
        "align_position_m": tight.start_position_m,
        "align_velocity_m_s": tight.start_velocity_m_s,
        "align_level_deg": tight.start_level_deg,
        "align_heading_deg": tight.start_heading_deg,
    }
    rate = config.rate.model_copy(update={k: v for k, v in known.items() if k not in own})
    return config.model_copy(update={"rate": rate})


def _first(log: ImuLog, start: Start) -> InertialStates:
    """The start as a state."""
    return InertialStates(
        log.reference,
        np.array([start.time_s]),
        np.array([start.position_m]),
        np.array([start.velocity_m_s]),
        np.array([start.attitude_rad]),
        np.zeros(1),
    )
