"""Errors of free inertial navigation in local axes, by the phi-angle model, for many flights.

A check of the strapdown computer that shares nothing with it, and many times as fast: linear, with
a round Earth of the radius at the place. With L the latitude, v the velocity, f the specific force,
w_e the Earth's rotation and w_t that of the local axes, all in north, east, down:

    dp' = dv
    dv' = f x phi + C ba - (2 w_e + w_t) x dv - (2 dw_e + dw_t) x v + 2 g / R dp_down
    phi' = -(w_e + w_t) x phi + dw_e + dw_t - C bg

Titterton and Weston, Strapdown Inertial Navigation Technology, 2nd ed., section 12.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from .flights import Sampled

    Floats = NDArray[np.float64]

EARTH_RATE = 7.292115e-5
RADIUS_M = 6.371e6
GRAVITY_M_S2 = 9.797
"""At 34 degrees."""
BLOCK = 100
"""Steps whose transitions are held at a time."""


@dataclass(frozen=True)
class Drift:
    """Errors of K INS on each of R flights at M whole seconds, east, north, up, INS minus truth."""

    position_m: Floats
    """(K, R, M, 3)"""
    velocity_m_s: Floats
    """(K, R, M, 3)"""

    @property
    def rate_m_s(self) -> Floats:
        """Error of the displacement over each second, (K, R, M - 1, 3)."""
        return np.diff(self.position_m, axis=2)


def grow(flights: Sampled, gyro: Floats, accelerometer: Floats, realign_s: float = np.inf) -> Drift:
    """Drift of INS with constant biases, aligned perfectly at 0 s and each ``realign_s``.

    Args:
        flights: R of them, at least two rows a second.
        gyro: biases in rad/s, (K, R, 3).
        accelerometer: in m/s^2, (K, R, 3).
        realign_s: time between alignments, whole seconds.
    """
    per = round(1 / (flights.time_s[1] - flights.time_s[0]))
    state = np.zeros((flights.runs, 9, len(gyro)))
    bias = np.moveaxis(np.concatenate([gyro, accelerometer], axis=-1), 0, -1)
    kept = [state]
    for row, (transition, entry) in enumerate(_steps(flights), start=1):
        state = transition @ state + entry @ bias
        if row % per == 0:
            second = row // per
            kept.append(state)
            if second % realign_s == 0:
                state = np.zeros_like(state)
    found = np.moveaxis(np.stack(kept), (1, 2, 3), (1, 3, 0))[..., [1, 0, 2, 4, 3, 5]]
    found *= np.array([1.0, 1.0, -1.0] * 2)
    return Drift(found[..., :3], found[..., 3:])


def _steps(flights: Sampled) -> Iterator[tuple[Floats, Floats]]:
    """Transition (R, 9, 9), and what biases of gyros and accelerometers enter, (R, 9, 6)."""
    step = flights.time_s[1] - flights.time_s[0]
    for first in range(0, flights.time_s.size - 1, BLOCK):
        rows = slice(first, first + BLOCK + 1)
        latitude, velocity, attitude = (
            _middle(values[:, rows])
            for values in (flights.latitude_rad, flights.velocity_m_s, flights.attitude)
        )
        gained = np.diff(flights.velocity_m_s[:, rows], axis=1) / step
        rate = _dynamics(latitude, velocity, gained) * step
        transition = np.eye(9) + rate + rate @ rate / 2
        entry = np.zeros((*rate.shape[:3], 6))
        entry[..., 6:, :3] = -attitude * step
        entry[..., 3:6, 3:] = attitude * step
        entry += rate @ entry / 2
        for k in range(rate.shape[1]):
            yield transition[:, k], entry[:, k]


def _middle(values: Floats) -> Floats:
    return np.asarray(0.5 * (values[:, 1:] + values[:, :-1]))


def _dynamics(latitude: Floats, velocity: Floats, gained: Floats) -> Floats:
    """Matrices (R, B, 9, 9) of the model above."""
    sine, cosine = np.sin(latitude), np.cos(latitude)
    zero = np.zeros_like(sine)
    earth = EARTH_RATE * np.stack([cosine, zero, -sine], axis=-1)
    north, east = velocity[..., 0] / RADIUS_M, velocity[..., 1] / RADIUS_M
    turn = np.stack([east, -north, -east * sine / cosine], axis=-1)
    force = gained + np.cross(2 * earth + turn, velocity) - np.array([0, 0, GRAVITY_M_S2])
    by_velocity = np.zeros((*sine.shape, 3, 3))
    by_velocity[..., 0, 1], by_velocity[..., 1, 0] = 1 / RADIUS_M, -1 / RADIUS_M
    by_velocity[..., 2, 1] = -sine / cosine / RADIUS_M
    by_place, of_earth = np.zeros_like(by_velocity), np.zeros_like(by_velocity)
    by_place[..., 2, 0] = -east / cosine**2 / RADIUS_M
    of_earth[..., 0, 0] = -EARTH_RATE * sine / RADIUS_M
    of_earth[..., 2, 0] = -EARTH_RATE * cosine / RADIUS_M
    rate = np.zeros((*sine.shape, 9, 9))
    rate[..., :3, 3:6] = np.eye(3)
    moving = _cross(velocity)
    rate[..., 3:6, :3] = moving @ (2 * of_earth + by_place)
    rate[..., 5, 2] += 2 * GRAVITY_M_S2 / RADIUS_M
    rate[..., 3:6, 3:6] = moving @ by_velocity - _cross(2 * earth + turn)
    rate[..., 3:6, 6:] = _cross(force)
    rate[..., 6:, :3] = of_earth + by_place
    rate[..., 6:, 3:6] = by_velocity
    rate[..., 6:, 6:] = -_cross(earth + turn)
    return rate


def _cross(vector: Floats) -> Floats:
    x, y, z = np.moveaxis(vector, -1, 0)
    o = np.zeros_like(x)
    rows = [[o, -z, y], [z, o, -x], [-y, x, o]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
