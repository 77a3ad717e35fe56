"""Drift of a free INS: closed forms, the linear model, and the strapdown computer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.imu import grades
from sdr_spoof.reproduce.parallel import repeat
from sdr_spoof.reproduce.study import Number, Section, Table, near

from . import drift, published
from .flights import ORIGIN, Sampled
from .simulated import BIAS_SEED, RATE_NOISE_M_S, fleet, white
from .strapdown_runs import fly, standing

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from concurrent.futures import Executor

    from numpy.typing import NDArray

    from sdr_spoof.progress import Stages
    from sdr_spoof.reproduce.study import Cell, Effort

    from .strapdown_runs import Flown

    Floats = NDArray[np.float64]

SEED = 20_220_403
FLIGHTS, QUICK_FLIGHTS = 100, 2
CLOSURE_M_S, CLOSURE_M = 1e-4, 0.05
RELATIVE = 0.01
"""Of closed forms at rest."""
MODEL = 0.03
"""Of the linear model against the strapdown computer: second-order terms of N2's heading error."""


def section(effort: Effort, stages: Stages, executor: Executor | None) -> Section:
    """Closure, Schuler growth, ratio of grades, linear model against strapdown."""
    count = QUICK_FLIGHTS if effort.quick else FLIGHTS
    with stages("Strapdown navigation") as progress:
        still = standing()
        flights = repeat(fly, [(n, BIAS_SEED) for n in range(count)], executor, progress)
    return Section(
        "Drift of a free INS",
        text=(
            "Two independent computations: increments of 100 Hz through the strapdown computer, "
            "and a linear model of the errors in local axes. At rest both are within 1 % of the "
            "closed forms R eps (1 - cos w t) and (b / w) sin w t. Perfect increments close over "
            "1750 s of random flight. Perfect heading is assumed throughout, as published; "
            f"gyro-compassing with N1 would leave up to {compass_deg():.2f} degrees, "
            f"{40 * np.radians(compass_deg()):.2f} m/s across the track at 40 m/s.",
        ),
        tables=[_static_table(still), _flight_table(flights)],
        numbers=[*_static_numbers(still), *_flight_numbers(flights)],
    )


def compass_deg() -> float:
    """Heading error that gyro-compassing with N1 leaves: eps / (w cos L)."""
    horizontal = np.degrees(drift.EARTH_RATE) * 3600 * np.cos(np.radians(ORIGIN[0]))
    return float(np.degrees(0.1 / horizontal))


def linear_standing() -> tuple[Floats, Floats]:
    """North velocity by the gyro and east velocity by the accelerometer, by the linear model."""
    time_s = np.asarray(np.arange(2 * round(published.DURATION_S) + 1) * 0.5, np.float64)
    nothing = np.zeros((1, time_s.size, 3))
    latitude = np.full((1, time_s.size), np.radians(ORIGIN[0]))
    level = np.broadcast_to(np.eye(3), (1, time_s.size, 3, 3))
    still = Sampled(time_s, latitude, nothing, nothing, level)
    east = np.array([0.0, 1.0, 0.0])
    gyro = np.stack([0.1 * grades.DEG_HOUR * east, 0 * east])[:, None]
    force = np.stack([0 * east, 10 * grades.MICRO_G * east])[:, None]
    found = drift.grow(still, gyro, force).velocity_m_s[:, 0]
    return np.abs(found[0, :, 1]), np.abs(found[1, :, 0])


def _closed_forms() -> tuple[Floats, Floats]:
    time_s = np.array(published.STATIC_S, float)
    schuler = np.sqrt(drift.GRAVITY_M_S2 / drift.RADIUS_M)
    gyro = 0.1 * grades.DEG_HOUR * drift.RADIUS_M * (1 - np.cos(schuler * time_s))
    return gyro, 10 * grades.MICRO_G / schuler * np.sin(schuler * time_s)


def _columns(still: Flown) -> list[tuple[str, Floats, Floats]]:
    at = list(published.STATIC_S)
    gyro, force = linear_standing()
    north, east = np.abs(still.velocity_m_s[1, at, 1]), np.abs(still.velocity_m_s[2, at, 0])
    return [
        ("closed form", *_closed_forms()),
        ("linear model", gyro[at], force[at]),
        ("strapdown", north, east),
    ]


def _static_table(still: Flown) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for what, number in (("0.1 deg/h about east: north", 1), ("10 ug east: east", 2)):
        reference = (published.GYRO_M_S, published.ACCELEROMETER_M_S)[number - 1]
        for k, time_s in enumerate(published.STATIC_S):
            found = [float(column[number][k]) for column in _columns(still)]
            rows.append((what, time_s, reference[k], *found))
    columns = ("bias: velocity error", "time (s)", "another simulation (m/s)", "closed form (m/s)")
    return Table(
        "schuler",
        "Velocity error of an INS at rest",
        (*columns, "linear model (m/s)", "strapdown (m/s)"),
        rows,
    )


def _static_numbers(still: Flown) -> Iterator[Number]:
    for method, gyro, force in _columns(still)[1:]:
        for values, wanted, name in (
            (gyro, published.GYRO_M_S, "gyro"),
            (force, published.ACCELEROMETER_M_S, "accelerometer"),
        ):
            for time_s, value, reference in zip(published.STATIC_S, values, wanted, strict=True):
                label = f"static_{name}_{time_s}_{method.replace(' ', '_')}"
                what = f"velocity error at rest after {time_s} s by the {name}, {method}"
                # The reference has three digits: half of the last one is allowed on top.
                digit = 10.0 ** (np.floor(np.log10(reference)) - 2)
                allowed = RELATIVE * reference + digit / 2
                yield near(label, what, float(value), reference, float(allowed), "m/s")


def differences(flights: Sequence[Flown]) -> Floats:
    """Rms of linear model minus strapdown over rms of the strapdown's, per grade, (2,)."""
    linear = fleet(len(flights)).free.velocity_m_s[:2, ..., :2]
    truth = np.stack([f.velocity_m_s[1:, :, :2] for f in flights], axis=1)
    apart = np.sqrt(((linear - truth) ** 2).mean(axis=(1, 2, 3)))
    return np.asarray(apart / np.sqrt((truth**2).mean(axis=(1, 2, 3))))


def _shares(flights: Sequence[Flown]) -> Floats:
    """False alarms of the rate form in percent by the strapdown computer, (2, 2)."""
    rng = np.random.default_rng(SEED)
    position = np.stack([f.position_m[1:] for f in flights], axis=1)
    rate = np.diff(position, axis=2)[:, :, : published.TESTED, :2]
    noise = white(rng, (len(flights), published.TESTED), RATE_NOISE_M_S)[..., :2]
    return np.asarray(100 * (np.abs(rate + noise) > published.RATE_M_S).mean(axis=(1, 2)))


def _flight_table(flights: Sequence[Flown]) -> Table:
    apart, shares = differences(flights), _shares(flights)
    rows: list[tuple[Cell, ...]] = []
    for grade, name in enumerate(published.GRADES):
        speed = np.stack([f.velocity_m_s[1 + grade] for f in flights])
        rms = np.sqrt((speed[:, list(published.STATIC_S), :2] ** 2).mean(axis=(0, 2)))
        rows.append(
            (name, *(float(r) for r in rms), *(float(s) for s in shares[grade]), apart[grade])
        )
    times = tuple(f"rms at {t} s (m/s)" for t in published.STATIC_S)
    return Table(
        "strapdown",
        "Horizontal velocity error on random flights, by the strapdown computer",
        ("INS", *times, "false alarms, east (%)", "false alarms, north (%)", "model apart"),
        rows,
        f"{len(flights)} flights of {published.DURATION_S:g} s; false alarms of the rate form at "
        "the printed thresholds; last column: rms difference of the linear model over the rms "
        "error.",
    )


def _flight_numbers(flights: Sequence[Flown]) -> Iterator[Number]:
    speed = max(float(np.linalg.norm(f.velocity_m_s[0], axis=1).max()) for f in flights)
    place = max(float(np.linalg.norm(f.position_m[0], axis=1).max()) for f in flights)
    what = "closure over 1750 s with perfect increments"
    yield Number("closure_m_s", f"{what}, velocity", speed, 0.0, CLOSURE_M_S, "m/s")
    yield Number("closure_m", f"{what}, position", place, 0.0, CLOSURE_M, "m")
    last = np.stack([f.velocity_m_s[1:, -1, :2] for f in flights], axis=1)
    ratio = float(np.sqrt((last[1] ** 2).sum() / (last[0] ** 2).sum()))
    yield near("n2_over_n1", "velocity errors of N2 over those of N1", ratio, 5.0, 0.05)
    for name, apart in zip(published.GRADES, differences(flights), strict=True):
        what = f"linear model against strapdown, {name.upper()}, relative rms"
        yield Number(f"model_{name}", what, float(apart), 0.0, MODEL)
    if len(flights) < FLIGHTS:
        return
    for grade, shares in zip(published.GRADES, _shares(flights), strict=True):
        wanted, tolerance = published.FALSE_ALARMS["rate", grade]
        for axis, name in enumerate(published.NAMES):
            label = f"false_alarms_strapdown_{grade}_{name}"
            what = f"false alarms by the strapdown computer, rate form, {grade.upper()}, {name}"
            yield near(label, what, float(shares[axis]), wanted[axis], tolerance, "%")
