"""What the phases say of the motion over each epoch, against what the INS says.

Over the time between two epochs the distance to a satellite changes by what the satellite and the
antenna do in that time. The INS gives the antenna's *displacement* over the same time, not its
velocity at the end, which in a turn of acceleration a would be off by a/2 per second. What is left
is the receiver's clock, noise, the drift of the INS, and an attack:

    change measured - change expected = clock - line . (displacement, GNSS - INS)

with the line of sight from the receiver to the satellite. Lines of sight are taken at the place
that the phases themselves lead to from the first fix: at that of a free INS, 500 m off, the same
satellite motion would look different by 0.08 m/s.

The phase at an epoch enters two changes, so that their noise is MA(1) with a correlation of -1/2:
a sum over K epochs has the noise of two phases, and a mean falls as 1/K.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import NavigationError
from sdr_spoof.scenario.sky import earth
from sdr_spoof.scenario.sky.trajectory import rotations

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sdr_spoof.aiding.rate_config import RateConfig
    from sdr_spoof.aiding.records import InertialStates, Measurements
    from sdr_spoof.aiding.strapdown import RunStates

    Floats = NDArray[np.float64]

LEAST_SATELLITES = 5
"""Three of displacement, one of clock, and one that can contradict."""
LARGEST_DOP = 20.0
"""Of a component of the displacement; beyond, the geometry is called degenerate."""
PASSES = 4
"""The place improves by a factor of five or more a pass."""
STRONG_DBHZ = 45.0


@dataclass(frozen=True)
class Changes:
    """GNSS against INS over E epochs, each since the epoch before; NaN where there is nothing."""

    time_s: Floats
    """End of each interval, (E,)."""
    interval_s: Floats
    """Its length; NaN at the first epoch and after a gap, (E,)."""
    unexplained_m: Floats
    """Measured minus expected change of each distance, the clock in it, (E, S)."""
    line: Floats
    """Unit vectors to the satellites, Earth-fixed, (E, S, 3)."""
    sigma_m: Floats
    """Noise of the phase of one satellite at one epoch, (E, S)."""
    axes: Floats
    """East, north, up, one a row, Earth-fixed, (E, 3, 3)."""
    displacement_m: Floats
    """GNSS minus INS, east, north, up, by least squares, (E, 3)."""
    clock_m: Floats
    """Change of the receiver's clock, (E,)."""
    covariance_m2: Floats
    """Of the noise of *one phase epoch* in east, north, up; a change has two, (E, 3, 3)."""
    same_set: NDArray[np.bool_]
    """Whether the satellites are those of the epoch before, (E,)."""
    segment: NDArray[np.int64]
    """Number of the unbroken piece, -1 where an epoch cannot be used, (E,)."""
    age_s: Floats
    """Time since alignment, (E,)."""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class States:
    """An INS at the epochs of the measurements, at the antenna."""

    position_m: Floats
    velocity_m_s: Floats
    attitude: Floats
    """Matrices from forward, right, down to Earth-fixed axes, (E, 3, 3)."""
    age_s: Floats


def changes(measurements: Measurements, states: InertialStates, config: RateConfig) -> Changes:
    """Compare every change of phase with the displacement of the INS.

    Raises:
        NavigationError: times of INS and measurements do not overlap, or have no common reference.
    """
    ins = at_epochs(measurements, states)
    interval = _intervals(measurements.time_s, config)
    noise = phase_sigma(measurements, config)
    usable = np.isfinite(measurements.change_m) & np.isfinite(noise)
    usable &= np.isfinite(measurements.satellite_m).all(axis=-1)
    usable &= np.vstack(
        [np.zeros_like(usable[:1]), np.isfinite(measurements.satellite_m[:-1, :, 0])]
    )
    usable &= (np.isfinite(ins.position_m[:, 0]) & np.isfinite(interval))[:, None]
    step, way = _moved(ins, measurements.time_s)
    usable &= np.isfinite(step[:, :1])
    origin = first_place(measurements, ins) + np.cumsum(way, axis=0)
    weight = np.where(usable, 1.0 / np.where(usable, noise, 1.0) ** 2, 0.0)
    place = origin
    for _ in range(PASSES):
        unexplained, line = _unexplained(measurements, place, step)
        found = _solve(np.where(usable, unexplained, 0.0), line, weight)
        place = origin + np.cumsum(np.nan_to_num(found[0]), axis=0)
    axes = earth.enu_axes(np.nan_to_num(place, nan=1.0))
    displacement = np.einsum("eij,ej->ei", axes, found[0])
    covariance = np.einsum("eij,ejk,elk->eil", axes, found[2], axes)
    good = np.isfinite(displacement[:, 0])
    segment = np.where(good, np.cumsum(~good), -1)
    return Changes(
        measurements.time_s,
        interval,
        np.where(usable, unexplained, np.nan),
        line,
        noise,
        axes,
        displacement,
        found[1],
        covariance,
        np.concatenate([[False], (usable[1:] == usable[:-1]).all(axis=1)]),
        segment,
        ins.age_s,
        _notes(usable, good, config),
    )


def at_epochs(measurements: Measurements, states: InertialStates) -> States:
    """The INS at the antenna at each epoch, by cubic Hermite; NaN where it does not reach.

    Raises:
        NavigationError: no overlap, or a reference that the other one lacks.
    """
    time_s = measurements.time_s
    if measurements.reference is not None and states.reference is not None:
        time_s = time_s + (measurements.reference - states.reference)
    elif (measurements.reference is None) != (states.reference is None):
        raise NavigationError(
            "the INS or the measurements have no reference time; give the GNSS time of the IMU's "
            "first sample"
        )
    ours = states.time_s
    if ours.size < 2 or time_s.size == 0 or time_s[-1] < ours[0] or time_s[0] > ours[-1]:
        raise NavigationError(
            f"{ours.size} states of the INS and {time_s.size} epochs of GNSS do not overlap; check "
            "the clock of the IMU"
        )
    inside = (time_s >= ours[0] - 1e-6) & (time_s <= ours[-1] + 1e-6)
    row = np.clip(np.searchsorted(ours, time_s + 1e-9) - 1, 0, ours.size - 2)
    length = ours[row + 1] - ours[row]
    part = np.clip((time_s - ours[row]) / length, 0.0, 1.0)[:, None]
    position, velocity = _hermite(states, row, length[:, None], part)
    angle = np.unwrap(states.attitude_rad, axis=0)
    attitude = rotations((1 - part) * angle[row] + part * angle[row + 1])
    turn = _to_earth(position) @ attitude
    lever = turn @ np.array(measurements.lever_arm_m)
    nearest = np.where(part[:, 0] < 1.0, row, row + 1)
    # Seconds since an alignment grow with time; across a new one the newer counts.
    age = states.aligned_s[nearest] + (time_s - ours[nearest])
    position[~inside], velocity[~inside] = np.nan, np.nan
    return States(position + lever, velocity, turn, age)


def at_states(states: InertialStates | RunStates) -> States:
    """One INS or many, (..., E), at their own times and their own point."""
    shape = (*states.position_m.shape, 3)
    turn = _to_earth(states.position_m.reshape(-1, 3)) @ rotations(
        states.attitude_rad.reshape(-1, 3)
    )
    return States(states.position_m, states.velocity_m_s, turn.reshape(shape), states.aligned_s)


def phase_sigma(measurements: Measurements, config: RateConfig) -> Floats:
    """Noise of a phase by its C/N0, in m, (E, S); NaN where there is too little of it."""
    cn0 = measurements.cn0_dbhz
    sigma = config.carrier_sigma_m * 10 ** (np.maximum(STRONG_DBHZ - cn0, 0.0) / 20)
    return np.where(cn0 >= config.min_cn0_dbhz, sigma, np.nan)


def first_place(measurements: Measurements, ins: States) -> Floats:
    """Where the first fix by code is, or the INS if there is none, (3,)."""
    place = _first(ins.position_m)
    epoch = int(np.argmax(np.isfinite(ins.position_m[:, 0])))
    there = np.isfinite(measurements.range_m[epoch])
    if there.sum() < LEAST_SATELLITES:
        return place
    satellites, ranges = measurements.satellite_m[epoch, there], measurements.range_m[epoch, there]
    best = place
    for _ in range(PASSES):
        away = satellites - best
        distance = np.linalg.norm(away, axis=1)
        design = np.column_stack([-away / distance[:, None], np.ones(there.sum())])
        moved, _, rank, _ = np.linalg.lstsq(design, ranges - distance, rcond=1e-6)
        best = best + moved[:3]
    return best if rank == 4 and np.isfinite(best).all() else place


def _moved(ins: States, time_s: Floats) -> tuple[Floats, Floats]:
    """Displacement by the INS, NaN where it was aligned anew within, and the way with that filled.

    (E, 3) each; the way is 0 where the INS does not reach.
    """
    step = np.diff(ins.position_m, axis=0, prepend=ins.position_m[:1] * np.nan)
    coasted = ins.velocity_m_s * np.diff(time_s, prepend=time_s[:1])[:, None]
    anew = np.diff(ins.age_s, prepend=ins.age_s[:1]) < 0
    step[anew] = np.nan
    return step, np.nan_to_num(np.where(anew[:, None], coasted, step))


def _first(values: Floats) -> Floats:
    there = np.isfinite(values[:, 0])
    return np.asarray(values[int(np.argmax(there))])


def _intervals(time_s: Floats, config: RateConfig) -> Floats:
    steps = np.diff(time_s, prepend=np.nan)
    return np.where((steps > 0) & (steps <= config.max_gap_s), steps, np.nan)


def _hermite(
    states: InertialStates, row: NDArray[np.int64], length: Floats, part: Floats
) -> tuple[Floats, Floats]:
    """Position and velocity between two states, by the cubic through both."""
    p0, p1 = states.position_m[row], states.position_m[row + 1]
    v0, v1 = states.velocity_m_s[row] * length, states.velocity_m_s[row + 1] * length
    step = p1 - p0
    bend = part * (1 - part)
    position = p0 + part * step + bend * ((1 - part) * (v0 - step) + part * (step - v1))
    velocity = ((1 - part) * v0 + part * v1 + 3 * bend * (2 * step - v0 - v1)) / length
    return position, velocity


def _to_earth(position_m: Floats) -> Floats:
    """Matrices from north, east, down to Earth-fixed axes, (E, 3, 3)."""
    axes = earth.enu_axes(position_m)
    return np.stack([axes[:, 1], axes[:, 0], -axes[:, 2]], axis=-1)


def _unexplained(measurements: Measurements, place: Floats, step: Floats) -> tuple[Floats, Floats]:
    """Measured minus expected changes (E, S), and lines of sight (E, S, 3)."""
    before = np.vstack([place[:1], place[:-1]])
    satellite = measurements.satellite_m
    away = satellite - (before + step)[:, None]
    away_before = np.concatenate([satellite[:1], satellite[:-1]]) - before[:, None]
    distance = np.linalg.norm(away, axis=-1)
    line = away / distance[..., None]
    expected = distance - np.linalg.norm(away_before, axis=-1)
    return measurements.change_m - expected, line


def _solve(unexplained: Floats, line: Floats, weight: Floats) -> tuple[Floats, Floats, Floats]:
    """Displacement (E, 3) and clock (E,) by weighted least squares, covariance (E, 3, 3)."""
    design = np.concatenate([-np.nan_to_num(line), np.ones((*line.shape[:2], 1))], axis=-1)
    normal = np.einsum("esi,es,esj->eij", design, weight, design)
    right = np.einsum("esi,es,es->ei", design, weight, unexplained)
    enough = (weight > 0).sum(axis=1) >= LEAST_SATELLITES
    scale = np.maximum(weight.max(axis=1), 1e-30)
    enough &= np.linalg.eigvalsh(normal)[:, 0] > scale / LARGEST_DOP**2
    normal[~enough] = np.eye(4)
    covariance = np.linalg.inv(normal)
    solution = np.einsum("eij,ej->ei", covariance, right)
    solution[~enough], covariance[~enough] = np.nan, np.nan
    return solution[:, :3], solution[:, 3], covariance[:, :3, :3]


def _notes(
    usable: NDArray[np.bool_], good: NDArray[np.bool_], config: RateConfig
) -> tuple[str, ...]:
    notes = []
    if usable.shape[1] and not good[1:].all():
        few = int((usable[1:].sum(axis=1) < LEAST_SATELLITES).sum())
        if few:
            notes.append(
                f"{few} epoch(s) with fewer than {LEAST_SATELLITES} satellites above "
                f"{config.min_cn0_dbhz:g} dB-Hz that the INS covers"
            )
        bad = int((~good[1:]).sum()) - few
        if bad > 0:
            notes.append(f"{bad} epoch(s) with degenerate geometry of the satellites")
    return tuple(notes)
