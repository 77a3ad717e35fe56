"""How the error of a free INS grows: linear error model in Earth-fixed axes, and its covariance.

State, 15 values: position, velocity and attitude error (INS minus truth; the attitude as a rotation
vector that turns the true axes into the computed ones), bias of the gyros, bias of the
accelerometers, the biases in body axes. With f the specific force, w the Earth's rotation, C the
attitude:

    dp' = dv
    dv' = psi x f + C ba - 2 w x dv + (gravity gradient) dp
    psi' = C bg - w x psi

Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd ed.,
section 14.2.2. The gravity gradient gives Schuler's oscillation and the growth of the height error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.scenario.sky.earth import SEMI_MAJOR_M

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .budget import Budget
    from .changes import States

    Floats = NDArray[np.float64]

EARTH_RATE = np.array([0.0, 0.0, 7.292115e-5])
"""rad/s, WGS 84."""
GM = 3.986004418e14
"""m^3/s^2, WGS 84."""
J2 = 1.08263e-3
"""Of the Earth's field."""
POSITION, VELOCITY, ATTITUDE, GYRO, ACCELEROMETER = (slice(3 * k, 3 * k + 3) for k in range(5))
STATES = 15
MANOEUVRE = 3.0
"""Errors of scale factors last as long as a manoeuvre, about ten epochs; the model takes them for
white, and so three times as large."""


@dataclass(frozen=True)
class Steps:
    """From each epoch to the next; leading axes are runs."""

    transition: Floats
    """From the epoch before, (..., E, 15, 15); the first is the identity."""
    noise: Floats
    """Covariance that the interval adds, (..., E, 15, 15)."""
    start: Floats
    """Covariance after alignment, (..., 15, 15)."""
    gained: Floats
    """What specific force adds to the velocity over the interval, (..., E, 3) in m/s."""
    aligned: NDArray[np.bool_]
    """Epochs before which the INS was aligned anew, (E,)."""


def gravity_gradient(position_m: Floats) -> Floats:
    """Derivative of gravity, the centrifugal part with it, by position, (..., 3, 3) in 1/s^2."""
    distance = np.linalg.norm(position_m, axis=-1)[..., None, None]
    up = position_m / distance[..., 0]
    along = up[..., :, None] * up[..., None, :]
    spin = EARTH_RATE[2] ** 2 * np.diag([1.0, 1.0, 0.0])
    return np.asarray(-GM / distance**3 * (np.eye(3) - 3 * along) + spin)


def gravity(position_m: Floats) -> Floats:
    """Gravity with the Earth's flattening (J2) and its spin, (..., 3) in m/s^2: good to 1e-5."""
    square = (position_m**2).sum(axis=-1, keepdims=True)
    sine2 = position_m[..., 2:] ** 2 / square
    flat = 1.5 * J2 * SEMI_MAJOR_M**2 / square
    parts = 1 + flat * (np.array([1.0, 1.0, 3.0]) - 5 * sine2)
    spin = EARTH_RATE[2] ** 2 * np.array([1.0, 1.0, 0.0])
    return np.asarray(position_m * (spin - GM / square**1.5 * parts))


def cross_matrix(vector: Floats) -> Floats:
    """Matrices of the cross product, (..., 3, 3)."""
    x, y, z = np.moveaxis(vector, -1, 0)
    o = np.zeros_like(x)
    rows = [[o, -z, y], [z, o, -x], [-y, x, o]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def steps(ins: States, time_s: Floats, budget: Budget) -> Steps:
    """Transitions between the epochs (..., E), from what the INS says of its motion.

    Where it says nothing, before its first and after its last state, it stands still there, and
    before the first one it is not aligned.
    """
    interval = np.diff(time_s, prepend=time_s[:1])
    known = np.isfinite(ins.position_m[..., 0]).reshape(-1, time_s.size)
    there = np.asarray(known.all(axis=0))
    first, last = int(there.argmax()), time_s.size - 1 - int(there[::-1].argmax())
    rows = np.clip(np.arange(time_s.size), first, last)
    position, velocity = ins.position_m[..., rows, :], ins.velocity_m_s[..., rows, :]
    turned, age = ins.attitude[..., rows, :, :], ins.age_s[rows]
    middle, speed = _middle(position), _middle(velocity)
    attitude = _middle(turned, axis=-3)
    gained = np.diff(velocity, axis=-2, prepend=velocity[..., :1, :])
    held = np.maximum(interval, 1e-9)[:, None]
    force = gained / held + 2 * np.cross(EARTH_RATE, speed) - gravity(middle)
    transition = _transition(middle, force, attitude, interval)
    noise = _noise(gained, turned, interval, budget)
    aligned = np.concatenate([[False], np.diff(age) < 0])
    aligned[first] |= first > 0
    start = _start(position[..., first, :], budget)
    if first < last and np.isfinite(age[first]):
        # What it did before the first epoch is not known here: as from there to the next.
        on, added = transition[..., first + 1, :, :], noise[..., first + 1, :, :]
        for _ in range(round(float(age[first] / interval[first + 1]))):
            start = on @ start @ np.swapaxes(on, -1, -2) + added
    return Steps(transition, noise, start, force * interval[:, None], aligned)


def covariances(steps: Steps) -> Floats:
    """Covariance of the error of the free INS at each epoch, (..., E, 15, 15)."""
    found = np.empty_like(steps.transition)
    now = steps.start
    for k in range(found.shape[-3]):
        there = steps.transition[..., k, :, :]
        now = there @ now @ np.swapaxes(there, -1, -2) + steps.noise[..., k, :, :]
        if steps.aligned[k]:
            now = steps.start
        found[..., k, :, :] = now
    return found


def displacement_covariances(steps: Steps, covariance: Floats) -> Floats:
    """Of the error of the displacement over each interval, Earth-fixed, (..., E, 3, 3)."""
    moved = steps.transition[..., POSITION, :].copy()
    moved[..., POSITION] -= np.eye(3)
    before = np.concatenate([covariance[..., :1, :, :], covariance[..., :-1, :, :]], axis=-3)
    spread = moved @ before @ np.swapaxes(moved, -1, -2)
    return np.asarray(spread + steps.noise[..., POSITION, POSITION])


def _middle(values: Floats, axis: int = -2) -> Floats:
    """Mean of each epoch and the one before; the first as it is."""
    first = np.take(values, [0], axis=axis)
    rest = [slice(None)] * values.ndim
    rest[axis] = slice(None, -1)
    before = np.concatenate([first, values[tuple(rest)]], axis=axis)
    return np.asarray(0.5 * (values + before))


def _transition(position: Floats, force: Floats, attitude: Floats, interval: Floats) -> Floats:
    """exp(F interval) to third order."""
    rate = np.zeros((*position.shape[:-1], STATES, STATES))
    rate[..., POSITION, VELOCITY] = np.eye(3)
    rate[..., VELOCITY, POSITION] = gravity_gradient(position)
    rate[..., VELOCITY, VELOCITY] = -2 * cross_matrix(EARTH_RATE)
    rate[..., VELOCITY, ATTITUDE] = -cross_matrix(force)
    rate[..., VELOCITY, ACCELEROMETER] = attitude
    rate[..., ATTITUDE, ATTITUDE] = -cross_matrix(EARTH_RATE)
    rate[..., ATTITUDE, GYRO] = attitude
    rate *= interval[:, None, None]
    square = rate @ rate
    return np.asarray(np.eye(STATES) + rate + square / 2 + square @ rate / 6)


def _noise(gained: Floats, attitude: Floats, interval: Floats, budget: Budget) -> Floats:
    """White noise of the sensors, and what scale factors and misalignment make of a manoeuvre."""
    noise = np.zeros((*gained.shape[:-1], STATES, STATES))
    shake = budget.accelerometer_density**2 * interval
    shake = shake + (MANOEUVRE * budget.accelerometer_scale) ** 2 * (gained**2).sum(axis=-1)
    turned = np.diff(attitude, axis=-3, prepend=attitude[..., :1, :, :])
    walk = budget.gyro_density**2 * interval
    walk = walk + (MANOEUVRE * budget.gyro_scale) ** 2 * (turned**2).sum(axis=(-1, -2)) / 2
    h, one = interval[:, None, None], np.eye(3)
    shake = shake[..., None, None] * one
    noise[..., VELOCITY, VELOCITY] = shake
    noise[..., POSITION, VELOCITY] = noise[..., VELOCITY, POSITION] = shake * h / 2
    noise[..., POSITION, POSITION] = shake * h**2 / 3
    noise[..., ATTITUDE, ATTITUDE] = walk[..., None, None] * one
    noise[..., GYRO, GYRO] = budget.gyro_walk * h * one
    noise[..., ACCELEROMETER, ACCELEROMETER] = budget.accelerometer_walk * h * one
    return noise


def _start(position_m: Floats, budget: Budget) -> Floats:
    """After alignment: position, velocity, level, heading, and the biases of the sensors."""
    up = position_m / np.linalg.norm(position_m, axis=-1, keepdims=True)
    along = up[..., :, None] * up[..., None, :]
    start = np.zeros((*up.shape[:-1], STATES, STATES))
    start[..., POSITION, POSITION] = budget.position_m**2 * np.eye(3)
    start[..., VELOCITY, VELOCITY] = budget.velocity_m_s**2 * np.eye(3)
    start[..., ATTITUDE, ATTITUDE] = (
        budget.level_rad**2 * (np.eye(3) - along) + budget.heading_rad**2 * along
    )
    start[..., GYRO, GYRO] = budget.gyro_bias**2 * np.eye(3)
    start[..., ACCELEROMETER, ACCELEROMETER] = budget.accelerometer_bias**2 * np.eye(3)
    return start
