"""The simulated voyage: a ship on waves, ten satellites, an IMU of a grade, attacks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from sdr_spoof.aiding.imu.grades import draw
from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.aiding.simulated import ReceiverNoise, fixed, simulate
from sdr_spoof.aiding.tight import Start, TightConfig, TightSolution, run_many
from sdr_spoof.aiding.tight.solution import local
from sdr_spoof.reproduce.study import Effort
from sdr_spoof.scenario.sky.ship import Ship

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import ImuLog, InertialStates
    from sdr_spoof.aiding.simulated import Attack

    Floats = NDArray[np.float64]

SEED = 20_260_004
DURATION_S = 1500.0
IMU_HZ = 100.0
SKY_DEG = (
    (14, 49),
    (30, 70),
    (81, 16),
    (112, 34),
    (133, 19),
    (155, 52),
    (239, 70),
    (303, 40),
    (327, 33),
    (347, 55),
)
"""Azimuths and elevations of the satellites."""
NAMES = tuple(f"C{k:02d}" for k in range(19, 19 + len(SKY_DEG)))
ATTACK_S = (600.0, 1000.0)
CLOCK_DRIFT_M2_S3 = 0.0004
"""Of the receiver's clock; a TCXO by the study."""
CHUNK = 20
"""Runs in memory at a time."""
APART = 100_000
"""Numbers of runs of one seed."""
ONE_THREAD = Effort(1)


def default_set(**other: Any) -> TightConfig:
    """The default, with what is known of the clock of the study."""
    return TightConfig(**({"clock_drift_m2_s3": CLOCK_DRIFT_M2_S3} | other))


@dataclass(frozen=True)
class Voyage:
    """What all runs share."""

    log: ImuLog
    truth: InertialStates
    """At the epochs."""
    time_s: Floats


@dataclass(frozen=True)
class Case:
    """One set of runs."""

    attacks: tuple[Attack, ...] = ()
    grade: str = "ship-a"
    config: TightConfig = field(default_factory=default_set)
    runs: int = 20
    first: int = 0
    """Number of the first run: calibration and judgement use different ones."""
    noise: ReceiverNoise = field(default_factory=ReceiverNoise)


@lru_cache(maxsize=2)
def voyage(duration_s: float = DURATION_S, interval_s: float = 1.0) -> Voyage:
    """Course, waves and perfect increments."""
    ship = Ship(kind="ship", seed=4, latitude_deg=30.5, longitude_deg=122.3, height_m=5.0)
    trajectory = ship.trajectory(duration_s)
    time_s = np.arange(0.0, duration_s, interval_s)
    log = ideal_increments(trajectory, duration_s, IMU_HZ)
    return Voyage(log, true_states(trajectory, time_s), time_s)


def runs(
    case: Case, effort: Effort = ONE_THREAD, *, detailed: bool = False
) -> Iterator[TightSolution]:
    """Solutions of all runs, one after another, with the threads and the seed of an effort."""
    begin = case.first + APART * effort.seed
    for first in range(begin, begin + case.runs, CHUNK):
        count = min(CHUNK, begin + case.runs - first)
        yield from _chunk(case, first, count, effort.threads, detailed)


def _chunk(
    case: Case, first: int, count: int, threads: int, detailed: bool
) -> Sequence[TightSolution]:
    way = voyage()
    moving = (way.truth.position_m, way.truth.velocity_m_s)
    sky = fixed(way.time_s, way.truth.position_m[0], SKY_DEG, NAMES)
    made = [
        simulate(moving, sky, way.time_s, case.noise, attacks=case.attacks, seed=SEED + number)
        for number in range(first, first + count)
    ]
    stack = tuple(
        np.concatenate([getattr(m, name) for m in made])
        for name in ("range_m", "rate_m_s", "change_m")
    )
    grade = [draw(case.grade, SEED + number)[0] for number in range(first, first + count)]
    errors = [replace(e, run=number) for number, e in enumerate(grade, first)]
    starts = [_start(case.config, way, number) for number in range(first, first + count)]
    return run_many(
        way.log,
        made[0].run(0),
        stack,  # type: ignore[arg-type]
        starts,
        case.config,
        errors=errors,
        detailed=detailed,
        threads=threads,
    )


def _start(config: TightConfig, way: Voyage, number: int) -> Start:
    """The truth with errors of the size that the filter believes in."""
    rng = np.random.default_rng([SEED, 7, number])
    level, heading = np.radians([config.start_level_deg, config.start_heading_deg])
    truth = way.truth
    position = truth.position_m[0] + config.start_position_m * rng.standard_normal(3)
    velocity = truth.velocity_m_s[0] + config.start_velocity_m_s * rng.standard_normal(3)
    attitude = truth.attitude_rad[0] + rng.standard_normal(3) * [heading, level, level]
    return Start(
        float(way.time_s[0]),
        tuple(position.tolist()),
        tuple(velocity.tolist()),
        tuple(attitude.tolist()),
    )


def errors_ned_m(solution: TightSolution) -> Floats:
    """North, east, down (E, 3)."""
    return np.asarray(solution.error_ned_m(voyage().truth.position_m))


def horizontal_m(solution: TightSolution) -> Floats:
    """Distance from the truth (E,)."""
    north, east, _ = errors_ned_m(solution).T
    return np.asarray(np.hypot(north, east))


def velocity_errors_ned_m_s(solution: TightSolution) -> Floats:
    """North, east, down (E, 3)."""
    truth = voyage().truth
    return np.asarray(solution.velocity_ned_m_s - local(truth.velocity_m_s, truth.position_m))
