"""Which satellites of an array's recordings come from near by: from tracks to a verdict.

Each unbroken piece of a satellite's phase differences is tested again and again while the vehicle
moves on, each time with the epochs since the piece began. The false-alarm probability is that of
the whole recording: it is shared equally among all tests of all satellites (Bonferroni), which a
union bound makes safe however they are correlated. Where the delays of the lines are calibrated,
each second is tested for its direction of arrival as well.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ndtr

from sdr_spoof.errors import AidingError
from sdr_spoof.signals import LIGHT_M_S, signal_spec

from . import arrival, motion, slips, verdict
from .config import ArrayConfig
from .phases import ArrayPhases
from .tracks import differences, noise_cycles

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from sdr_spoof.records import TrackLog

    from .geometry import AntennaArray
    from .tracks import Differences

    Floats = NDArray[np.float64]

GRID_S = 0.1
"""Spacing of the phases; their noise is taken as white at it."""
_SECOND = round(1.0 / GRID_S)
"""Epochs of a test of the direction of arrival."""


@dataclass(frozen=True)
class Vehicle:
    """What an INS says at the instants of the phases, and where the satellites should be."""

    time_s: Floats
    """Since the first sample, every :data:`GRID_S`, (E,)."""
    attitude_rad: Floats
    """Yaw, pitch, roll, (E, 3)."""
    place_m: Floats
    """Of the reference antenna: north, east, down from the first one, (E, 3)."""
    look: Callable[[str], Floats | None]
    """Unit vectors north, east, down to a satellite by its RINEX name, (E, 3), or None."""


@dataclass(frozen=True)
class Arrivals:
    """Directions of arrival of one signal against its satellite's, T tests."""

    time_s: Floats
    """End of each, (T,)."""
    score: Floats
    """Statistic as a normal number, (T,)."""

    @property
    def p_value(self) -> Floats:
        """Probability under H0 of so large a statistic, (T,)."""
        return np.asarray(ndtr(-self.score))


@dataclass(frozen=True)
class Finding:
    """One satellite's signal on the array."""

    satellite: str
    signal: str
    verdict: str
    reason: str
    sigma_cycles: float
    """Phase noise of one antenna, as measured."""
    time_s: Floats
    """Of the tests, (T,)."""
    way_m: Floats
    """Between the first and the last epoch of each test, (T,)."""
    score: Floats
    """Statistic as a normal number, (T,)."""
    p_value: Floats
    """(T,)"""
    threshold: float
    """Of the scores."""
    alarm_s: float | None
    """Of the first test of either kind."""
    arrivals: Arrivals | None = None
    """None where the lines are not calibrated, or no orbit is known."""


def examine(
    logs: Sequence[TrackLog],
    array: AntennaArray,
    vehicle: Vehicle,
    config: ArrayConfig | None = None,
    lines_m: Sequence[float] | None = None,
) -> list[Finding]:
    """Test every signal that all antennas hold.

    Args:
        logs: tracks of each antenna, the reference first.
        array: where the antennas are.
        vehicle: the INS at instants every :data:`GRID_S`.
        config: how to test.
        lines_m: by how much longer each antenna's line is than the reference's, as calibrated,
            (A - 1,); None: not calibrated, directions of arrival are not tested.

    Raises:
        AidingError: fewer logs than antennas, or the reverse, or lines for others than these.
    """
    config = config or ArrayConfig()
    check_number(len(logs), array)
    check_lines(lines_m, array)
    found = differences(logs, vehicle.time_s)
    plans = [_plan(d, array, vehicle, config, lines_m) for d in found]
    tests = sum(len(p.ends) + len(p.seconds) for p in plans)
    each = config.false_alarm_probability / max(tests, 1)
    return [_finding(p, array, vehicle, config, each) for p in plans]


def check_number(recordings: int, array: AntennaArray) -> None:
    """Refuse more or fewer recordings than antennas."""
    antennas = len(array.baselines_m) + 1
    if recordings != antennas:
        raise AidingError(f"{recordings} recordings for an array of {antennas} antennas")


def check_lines(lines_m: Sequence[float] | None, array: AntennaArray) -> None:
    """Refuse calibrations of more or fewer lines than there are beside the reference's."""
    if lines_m is not None and len(lines_m) != len(array.baselines_m):
        raise AidingError(
            f"{len(lines_m)} calibrated lines for an array of {len(array.baselines_m)} antennas "
            "beside the reference; give one number for each"
        )


@dataclass(frozen=True)
class _Plan:
    of: Differences
    sigma_cycles: float
    expected: Floats | None
    ends: list[tuple[int, int]]
    """First and last epoch of each test of motion."""
    seconds: list[NDArray[np.intp]]
    """Epochs of each test of the direction of arrival."""


def _plan(
    of: Differences,
    array: AntennaArray,
    vehicle: Vehicle,
    config: ArrayConfig,
    lines_m: Sequence[float] | None,
) -> _Plan:
    """Where a satellite can be tested."""
    wavelength = _wavelength_m(of)
    if lines_m is not None:
        of = replace(of, cycles=of.cycles - np.asarray(lines_m) / wavelength)
    expected = vehicle.look(of.satellite)
    # Where no orbit is known, the zenith: level motion in it changes no phase.
    about = (
        np.broadcast_to([0.0, 0.0, -1.0], (len(vehicle.time_s), 3))
        if expected is None
        else expected
    )
    piece = slips.pieces(
        array, of.cycles, vehicle.attitude_rad, about, wavelength, of.least_slip_cycles / 2
    )
    ends: list[tuple[int, int]] = []
    seconds: list[NDArray[np.intp]] = []
    for number in range(piece.max(initial=-1) + 1):
        rows = np.flatnonzero(piece == number)
        way = np.linalg.norm(vehicle.place_m[rows] - vehicle.place_m[rows[0]], axis=1)
        wanted = config.least_way_m
        for row, gone in zip(rows, way, strict=True):
            if gone >= wanted:
                ends.append((int(rows[0]), int(row)))
                wanted = gone + config.test_every_m
        if lines_m is not None and expected is not None:
            whole = rows[: rows.size // _SECOND * _SECOND].reshape(-1, _SECOND)
            seconds += list(whole)
    return _Plan(of, noise_cycles(of.cycles), expected, ends, seconds)


def _finding(
    plan: _Plan, array: AntennaArray, vehicle: Vehicle, config: ArrayConfig, pfa: float
) -> Finding:
    threshold = motion.normal_threshold(pfa)
    noisy = not np.isfinite(plan.sigma_cycles)
    usable = [] if noisy else plan.ends
    rows = [_test(plan, first, last, array, vehicle, config) for first, last in usable]
    table = np.array(rows).reshape(-1, 4)
    time_s, way_m, score, p_value = table[np.isfinite(table[:, 2])].T
    arrivals = None if noisy or not plan.seconds else _arrivals(plan, array, vehicle, config)
    said = [verdict.moved(time_s, way_m, score, threshold)]
    if arrivals is not None:
        said.append(verdict.arrived(arrivals.time_s, arrivals.score, threshold))
    alarms = [at for at, _ in said if at is not None]
    return Finding(
        plan.of.satellite,
        plan.of.signal,
        *verdict.of(said, config.least_way_m),
        plan.sigma_cycles,
        time_s,
        way_m,
        score,
        p_value,
        threshold,
        min(alarms, default=None),
        arrivals,
    )


def _test(
    plan: _Plan,
    first: int,
    last: int,
    array: AntennaArray,
    vehicle: Vehicle,
    config: ArrayConfig,
) -> tuple[float, float, float, float]:
    """Time, way, score and probability of one test."""
    count = min(config.most_epochs, last - first + 1)
    rows = np.unique(np.linspace(first, last, count).round().astype(np.intp))
    phases = _phases(plan, rows, vehicle, config, config.yaw_sigma_deg)
    value = motion.statistic(array, phases, config.form)
    epochs = len(rows)
    score = motion.normal_score(value, config.form, epochs)
    way = float(np.linalg.norm(phases.displacement_m[-1]))
    p = float(motion.p_value(value, config.form, epochs))
    return float(vehicle.time_s[last]), way, float(score), p


def _arrivals(plan: _Plan, array: AntennaArray, vehicle: Vehicle, config: ArrayConfig) -> Arrivals:
    scores = []
    for rows in plan.seconds:
        phases = _phases(plan, rows, vehicle, config, config.heading_sigma_deg)
        scores.append(float(arrival.score(arrival.statistic_of_all(array, phases), array)))
    return Arrivals(vehicle.time_s[[rows[-1] for rows in plan.seconds]], np.array(scores))


def _phases(
    plan: _Plan,
    rows: NDArray[np.intp],
    vehicle: Vehicle,
    config: ArrayConfig,
    yaw_sigma_deg: float,
) -> ArrayPhases:
    """What some epochs measure."""
    cycles, place = plan.of.cycles[rows], vehicle.place_m[rows]
    return ArrayPhases(
        vehicle.time_s[rows],
        cycles - np.round(cycles[0]),
        vehicle.attitude_rad[rows],
        place - place[0],
        plan.sigma_cycles,
        _wavelength_m(plan.of),
        None if plan.expected is None else plan.expected[rows],
        known_cycles=False,
        cycle_step=plan.of.least_slip_cycles,
        yaw_sigma_rad=float(np.radians(yaw_sigma_deg)),
        bias_sigma_cycles=config.line_sigma_cycles,
    )


def _wavelength_m(of: Differences) -> float:
    return LIGHT_M_S / signal_spec(of.signal).carrier_hz
