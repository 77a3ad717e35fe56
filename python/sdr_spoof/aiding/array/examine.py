"""Which satellites of an array's recordings come from near by: from tracks to a verdict.

Each unbroken piece of a satellite's phase differences is tested again and again while the vehicle
moves on, each time with the epochs since the piece began. The false-alarm probability is that of
the whole recording: it is shared equally among all tests of all satellites (Bonferroni), which a
union bound makes safe however they are correlated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import AidingError
from sdr_spoof.signals import LIGHT_M_S, signal_spec

from . import motion, slips
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
SPOOFED, CLEAN, NO_SUPPORT = "spoofed", "clean", "not enough support"


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
    """Of the score."""
    alarm_s: float | None


def examine(
    logs: Sequence[TrackLog],
    array: AntennaArray,
    vehicle: Vehicle,
    config: ArrayConfig | None = None,
) -> list[Finding]:
    """Test every signal that all antennas hold.

    Args:
        logs: tracks of each antenna, the reference first.
        array: where the antennas are.
        vehicle: the INS at instants every :data:`GRID_S`.
        config: how to test.

    Raises:
        AidingError: fewer logs than antennas, or the reverse.
    """
    config = config or ArrayConfig()
    check_number(len(logs), array)
    plans = [_plan(d, array, vehicle, config) for d in differences(logs, vehicle.time_s)]
    tests = sum(len(p.ends) for p in plans)
    each = config.false_alarm_probability / max(tests, 1)
    return [_finding(p, array, vehicle, config, each) for p in plans]


def check_number(recordings: int, array: AntennaArray) -> None:
    """Refuse more or fewer recordings than antennas."""
    antennas = len(array.baselines_m) + 1
    if recordings != antennas:
        raise AidingError(f"{recordings} recordings for an array of {antennas} antennas")


@dataclass(frozen=True)
class _Plan:
    of: Differences
    sigma_cycles: float
    expected: Floats | None
    ends: list[tuple[int, int]]
    """First and last epoch of each test."""


def _plan(of: Differences, array: AntennaArray, vehicle: Vehicle, config: ArrayConfig) -> _Plan:
    """Where a satellite can be tested."""
    wavelength = LIGHT_M_S / signal_spec(of.signal).carrier_hz
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
    for number in range(piece.max(initial=-1) + 1):
        rows = np.flatnonzero(piece == number)
        way = np.linalg.norm(vehicle.place_m[rows] - vehicle.place_m[rows[0]], axis=1)
        wanted = config.least_way_m
        for row, gone in zip(rows, way, strict=True):
            if gone >= wanted:
                ends.append((int(rows[0]), int(row)))
                wanted = gone + config.test_every_m
    return _Plan(of, noise_cycles(of.cycles), expected, ends)


def _finding(
    plan: _Plan, array: AntennaArray, vehicle: Vehicle, config: ArrayConfig, pfa: float
) -> Finding:
    threshold = motion.normal_threshold(pfa)
    usable = plan.ends if np.isfinite(plan.sigma_cycles) else []
    rows = [_test(plan, first, last, array, vehicle, config) for first, last in usable]
    table = np.array(rows).reshape(-1, 4)
    table = table[np.isfinite(table[:, 2])]
    over = np.flatnonzero(table[:, 2] > threshold)
    alarm_s = float(table[over[0], 0]) if over.size else None
    verdict, reason = _verdict(table, alarm_s, threshold, config)
    return Finding(
        plan.of.satellite,
        plan.of.signal,
        verdict,
        reason,
        plan.sigma_cycles,
        table[:, 0],
        table[:, 1],
        table[:, 2],
        table[:, 3],
        threshold,
        alarm_s,
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
    cycles = plan.of.cycles[rows]
    place = vehicle.place_m[rows]
    phases = ArrayPhases(
        vehicle.time_s[rows],
        cycles - np.round(cycles[0]),
        vehicle.attitude_rad[rows],
        place - place[0],
        plan.sigma_cycles,
        LIGHT_M_S / signal_spec(plan.of.signal).carrier_hz,
        None if plan.expected is None else plan.expected[rows],
        known_cycles=False,
        cycle_step=plan.of.least_slip_cycles,
        yaw_sigma_rad=float(np.radians(config.yaw_sigma_deg)),
        bias_sigma_cycles=config.line_sigma_cycles,
    )
    value = motion.statistic(array, phases, config.form)
    epochs = len(rows)
    score = motion.normal_score(value, config.form, epochs)
    way = float(np.linalg.norm(place[-1] - place[0]))
    p = float(motion.p_value(value, config.form, epochs))
    return float(vehicle.time_s[last]), way, float(score), p


def _verdict(
    table: Floats, alarm_s: float | None, threshold: float, config: ArrayConfig
) -> tuple[str, str]:
    if not len(table):
        return NO_SUPPORT, (
            f"no unbroken phases over {config.least_way_m:g} m of motion on all antennas"
        )
    largest = f"{float(table[:, 2].max()):.1f} sigma against {threshold:.1f}"
    if alarm_s is None:
        way = float(table[:, 1].max())
        return CLEAN, f"its direction is a satellite's over up to {way:.0f} m; at most {largest}"
    return SPOOFED, (
        f"at {alarm_s:.1f} s its direction had moved as that of a source near by; at most {largest}"
    )
