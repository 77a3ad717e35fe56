"""What the tightly coupled filter says, as a track and as monitors."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from sdr_spoof.aiding.tight import TESTS
from sdr_spoof.aiding.tight.solution import FORMS, THREATS
from sdr_spoof.errors import AidingError
from sdr_spoof.scenario.sky.earth import enu_axes
from sdr_spoof.scenario.sky.trajectory import rotations

from . import alone
from .records import AidedTrack, Guard, Monitor, SmoothedTrack, Use

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.records import Measurements
    from sdr_spoof.aiding.tight import Smoothed, TightConfig, TightSolution

    Floats = NDArray[np.float64]

USES = np.array([Use.NONE, Use.USED, Use.USED, Use.EXCLUDED], np.uint8)
"""By the filter's numbers: missing, used, weakened, excluded."""
KINDS = {
    "rates": ("rates,", "threshold_rate"),
    "carrier phase": ("phase changes,", "threshold_change"),
    "codes": ("codes,", "threshold_code"),
    "place against old copies": ("separation,", "threshold_separation"),
    "clock against old copies": ("clock separation,", "threshold_clock"),
    "power": ("power", "threshold_power_db"),
}
"""Names of the filter's tests, how they begin, and where the threshold stands."""
PUBLISHED = ("R of position", "R of velocity", "R of pseudoranges", "R of rates")


def track_of(solution: TightSolution, measurements: Measurements, risk: float) -> AidedTrack:
    """The antenna's way, with protection levels.

    Args:
        solution: of the filter.
        measurements: what it was given.
        risk: probability that an error exceeds its protection level.
    """
    if measurements.reference is None:
        raise AidingError("the measurements know no GNSS time; give files that do")
    covariance = solution.covariance[:, 0]
    valid = np.where(solution.valid, 1.0, np.nan)
    factors = math.sqrt(-2 * math.log(risk)), float(norm.isf(risk / 2))
    horizontal = factors[0] * np.sqrt(_largest(covariance[:, :2, :2]))
    vertical = factors[1] * np.sqrt(covariance[:, 2, 2])
    wrong = [
        one_wrong(solution.apart_m, 2 * k, factor, level)
        for k, (factor, level) in enumerate(zip(factors, (horizontal, vertical), strict=True))
    ]
    spoofed = measurements.spoofed & np.isfinite(measurements.range_m)
    use = np.where(
        spoofed & (USES[solution.usage] == Use.EXCLUDED), Use.NAMED, USES[solution.usage]
    )
    return AidedTrack(
        reference=measurements.reference,
        time_s=solution.time_s,
        position_m=_antenna(solution, measurements.lever_arm_m) * valid[:, None],
        velocity_m_s=body_velocity(solution) * valid[:, None],
        attitude_rad=solution.attitude_rad * valid[:, None],
        sigma_enu_m=_sigma_enu(covariance),
        horizontal_m=horizontal,
        vertical_m=vertical,
        alone_m=alone.places(measurements),
        satellites=solution.satellites,
        use=use.astype(np.uint8),
        guard=solution.state,
        smoothed=_smoothed(solution.smoothed, measurements.lever_arm_m),
        horizontal_one_wrong_m=wrong[0],
        vertical_one_wrong_m=wrong[1],
    )


def one_wrong(apart_m: Floats | None, first: int, factor: float, level: Floats) -> Floats | None:
    """Protection level whichever one satellite is wrong, (E,).

    The filter without that satellite is right: the error of the whole one is at most its distance
    from it and what the other's covariance allows. At least the level without a fault.

    Args:
        apart_m: of a solution (E, S, 4); None where it was not asked for.
        first: 0: horizontal, 2: vertical.
        factor: standard deviations that an error exceeds with the probability accepted.
        level: without a fault.
    """
    if apart_m is None:
        return None
    bounds = apart_m[..., first] + factor * apart_m[..., first + 1]
    return np.fmax(level, np.fmax.reduce(bounds, axis=1))


def _smoothed(
    found: Smoothed | None, lever_arm_m: tuple[float, float, float]
) -> SmoothedTrack | None:
    if found is None:
        return None
    return SmoothedTrack(
        position_m=_antenna(found, lever_arm_m),
        velocity_m_s=body_velocity(found),
        attitude_rad=found.attitude_rad,
        sigma_enu_m=_sigma_enu(found.covariance[:, 0]),
    )


def _sigma_enu(covariance: Floats) -> Floats:
    """East, north, up from variances north, east, down (E, 3)."""
    return np.asarray(np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))[:, [1, 0, 2]])


def body_velocity(solution: TightSolution | Smoothed) -> Floats:
    """Earth-fixed velocity of the INS (E, 3)."""
    return _earth_fixed(solution.velocity_ned_m_s, solution.position_m)


def monitors_of(solution: TightSolution, config: TightConfig) -> tuple[Monitor, ...]:
    """The tests by which the filter decides: of each kind the largest deviate of its windows."""
    found = []
    for name, (begins, field) in KINDS.items():
        columns = [k for k, test in enumerate(TESTS) if test.startswith(begins)]
        value = _highest(solution.deviates[:, columns])
        value[solution.state == Guard.STARTING] = np.nan
        if not np.any(np.nan_to_num(value)):
            continue  # not tested at all
        raised = [e for e in solution.events if e.test and TESTS.index(e.test) in columns]
        deviate = max((e.deviate for e in raised), default=0.0)
        log10_p = 0.0 if begins == "power" else float(norm.logsf(deviate) / math.log(10))
        found.append(
            Monitor(
                name,
                solution.time_s,
                value,
                np.full(value.shape, getattr(config, field)),
                "dB" if begins == "power" else "sigma",
                raised[0].time_s if raised else None,
                raised[0].time_s - _window_s(raised[0].test) if raised else None,
                max(log10_p, -30.0) if raised else 0.0,
            )
        )
    return tuple(found)


def published_of(solution: TightSolution, config: TightConfig) -> tuple[Monitor, ...]:
    """The published statistics by their divisors; of satellites the largest."""
    form = FORMS.index(config.statistic_form)
    values = [
        *solution.solution_statistic[..., form].T,
        *(_highest(part) for part in np.moveaxis(solution.channel_statistic[..., form], -1, 0)),
    ]
    return tuple(
        Monitor(name, solution.time_s, value, np.full(value.shape, divisor), "1")
        for name, value, divisor in zip(PUBLISHED, values, config.divisors, strict=True)
        if np.isfinite(value).any()
    )


def three_way(solution: TightSolution, config: TightConfig) -> str:
    """The published verdict in words: for how long, and the log of satellites."""
    step_s = float(np.median(np.diff(solution.time_s))) if solution.time_s.size > 1 else 1.0
    spans = {
        name: int(np.count_nonzero(solution.threat == number)) * step_s
        for number, name in enumerate(THREATS)
    }
    if not spans[THREATS[1]] + spans[THREATS[2]]:
        return "no statistic R over 1"
    flagged = np.any(solution.flagged(config.divisors, config.statistic_form), axis=0).tolist()
    names = [n for n, hit in zip(solution.satellites, flagged, strict=True) if hit]
    of = f", R over 1 of {', '.join(names)}" if names else ""
    told = ", ".join(f"{name} for {spans[name]:.0f} s" for name in THREATS[1:])
    return f"{told}{of}"


def _window_s(test: str) -> float:
    """Length of signal that a test looks at, by its name: 10 of 'codes, 10 s'."""
    return next((float(word) for word in test.split() if word.isdecimal()), 1.0)


def _highest(values: Floats) -> Floats:
    """Largest of the last axis, NaN where there is none."""
    highest = np.where(np.isfinite(values), values, -np.inf).max(axis=-1, initial=-np.inf)
    return np.where(np.isfinite(highest), highest, np.nan)


def _largest(covariance: Floats) -> Floats:
    """Largest variance in any direction of the plane (E,)."""
    half = 0.5 * (covariance[:, 0, 0] + covariance[:, 1, 1])
    return np.asarray(
        half + np.hypot(0.5 * (covariance[:, 0, 0] - covariance[:, 1, 1]), covariance[:, 0, 1])
    )


def _antenna(solution: TightSolution | Smoothed, lever_arm_m: tuple[float, float, float]) -> Floats:
    if not any(lever_arm_m):
        return solution.position_m
    ned = rotations(np.nan_to_num(solution.attitude_rad)) @ np.array(lever_arm_m)
    return solution.position_m + _earth_fixed(ned, solution.position_m)


def _earth_fixed(ned: Floats, position_m: Floats) -> Floats:
    """Vectors north, east, down (E, 3) in Earth-fixed axes."""
    known = np.isfinite(position_m).all(axis=1, keepdims=True)
    axes = enu_axes(np.where(known, position_m, [6_378_137.0, 0.0, 0.0]))
    enu = np.stack([ned[:, 1], ned[:, 0], -ned[:, 2]], axis=-1)
    return np.asarray(np.einsum("ei,eix->ex", enu, axes))
