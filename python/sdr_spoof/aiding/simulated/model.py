"""From a true trajectory to the measurements of many runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.records import Measurements

from .attacks import Scene
from .clock import ClockWalk
from .noise import ReceiverNoise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.nav.time import GnssTime
    from sdr_spoof.scenario.sky.trajectory import Trajectory

    from .attacks import Attack
    from .satellites import Constellation

Moving = tuple["NDArray[np.float64]", "NDArray[np.float64]"]
"""Earth-fixed positions and velocities of the antenna, (E, 3) each."""
EVEN = 1e-6
"""Epochs are evenly spaced to this share of their interval."""


@dataclass(frozen=True)
class Simulated:
    """R runs over the same E epochs of S satellites, and the truth."""

    reference: GnssTime | None
    time_s: NDArray[np.float64]
    """(E,)"""
    constellation: Constellation
    position_m: NDArray[np.float64]
    """True antenna, Earth-fixed (E, 3)."""
    velocity_m_s: NDArray[np.float64]
    """Likewise."""
    clock_m: NDArray[np.float64]
    """(R, E)"""
    drift_m_s: NDArray[np.float64]
    """(R, E)"""
    range_m: NDArray[np.float64]
    """(R, E, S), as are ``rate_m_s`` and ``change_m``: see :class:`Measurements`."""
    rate_m_s: NDArray[np.float64]
    change_m: NDArray[np.float64]
    cn0_dbhz: NDArray[np.float64]
    """(E, S)"""
    attacked: NDArray[np.bool_]
    """Whether an attack is on the air, (E, S)."""
    lever_arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.range_m)

    def run(self, number: int = 0) -> Measurements:
        """One run as a receiver would hand it on; no satellite is known to be spoofed."""
        return Measurements(
            reference=self.reference,
            time_s=self.time_s,
            satellites=self.constellation.names,
            satellite_m=self.constellation.position_m,
            satellite_velocity_m_s=self.constellation.velocity_m_s,
            range_m=self.range_m[number],
            rate_m_s=self.rate_m_s[number],
            change_m=self.change_m[number],
            cn0_dbhz=self.cn0_dbhz,
            spoofed=np.zeros_like(self.attacked),
            lever_arm_m=self.lever_arm_m,
        )


@dataclass(frozen=True)
class _Air:
    """Without noise and receiver's clock, (E, S) each."""

    code_m: NDArray[np.float64]
    phase_m: NDArray[np.float64]
    rate_m_s: NDArray[np.float64]
    slipped: NDArray[np.bool_]
    attacked: NDArray[np.bool_]
    cn0_dbhz: NDArray[np.float64]


def simulate(
    antenna: Trajectory | Moving,
    constellation: Constellation,
    time_s: NDArray[np.float64],
    noise: ReceiverNoise | None = None,
    clock: ClockWalk | None = None,
    attacks: Sequence[Attack] = (),
    seed: int = 1,
    runs: int = 1,
    *,
    reference: GnssTime | None = None,
    lever_arm_m: tuple[float, float, float] | None = None,
) -> Simulated:
    """Measurements of an antenna on its way.

    A run depends on the seed and its own number, not on how many there are; with and without
    attacks it has the same noise and clock.

    Args:
        antenna: its trajectory, or positions and velocities at the epochs.
        constellation: the satellites at the epochs.
        time_s: evenly spaced epochs (E,), system time since ``reference``.
        noise: of the receiver.
        clock: of the receiver.
        attacks: what is on the air; more than one may be at a time.
        seed: of the noise and of the clock.
        runs: how many.
        reference: instant of time 0.
        lever_arm_m: antenna from the INS, only handed on; by default that of the trajectory.

    Raises:
        ValueError: epochs are not even, shapes do not fit, or an attack names a satellite that is
            not there.
    """
    scene = _scene(antenna, np.asarray(time_s, np.float64), constellation)
    air = _on_air(scene, constellation, attacks)
    noise, clock = noise or ReceiverNoise(), clock or ClockWalk()
    drawn = [_run(np.random.default_rng([seed, k]), noise, clock, air, scene) for k in range(runs)]
    offset, drift, code, phase, doppler = (np.stack(part) for part in zip(*drawn, strict=True))
    change = np.diff(phase, axis=1, prepend=np.nan)
    change[:, air.slipped] = np.nan
    given = getattr(antenna, "lever_arm_m", (0.0, 0.0, 0.0))
    return Simulated(
        reference=reference,
        time_s=scene.time_s,
        constellation=constellation,
        position_m=scene.position_m,
        velocity_m_s=scene.velocity_m_s,
        clock_m=offset,
        drift_m_s=drift,
        range_m=code,
        rate_m_s=doppler,
        change_m=change,
        cn0_dbhz=air.cn0_dbhz,
        attacked=air.attacked,
        lever_arm_m=given if lever_arm_m is None else lever_arm_m,
    )


def _scene(
    antenna: Trajectory | Moving, time_s: NDArray[np.float64], constellation: Constellation
) -> Scene:
    steps = np.diff(time_s)
    if time_s.size < 2 or np.ptp(steps) > EVEN * steps.mean() or steps.min() <= 0:
        raise ValueError("epochs must be two or more, ascending and evenly spaced")
    if isinstance(antenna, tuple):
        position, velocity = (np.asarray(part, np.float64) for part in antenna)
    else:
        position, velocity = antenna.position_m(time_s), antenna.velocity_m_s(time_s)
    for shape in (position.shape, velocity.shape, constellation.position_m[:, 0].shape):
        if shape != (time_s.size, 3):
            raise ValueError(
                f"antenna and satellites must be given at each of the {time_s.size} epochs, "
                f"as ({time_s.size}, 3); one is of shape {shape}"
            )
    return Scene(time_s, position, velocity)


def _seen(
    position_m: NDArray[np.float64], velocity_m_s: NDArray[np.float64], sky: Constellation
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distances and their rates (E, S)."""
    way = sky.position_m - position_m[:, None]
    distance = np.linalg.norm(way, axis=-1)
    towards = sky.velocity_m_s - velocity_m_s[:, None]
    return distance, np.einsum("esx,esx->es", way, towards) / distance


def _on_air(scene: Scene, sky: Constellation, attacks: Sequence[Attack]) -> _Air:
    """What would be measured without noise, by a clock that is right."""
    true_m, true_m_s = _seen(scene.position_m, scene.velocity_m_s, sky)
    nobody = np.zeros(true_m.shape, np.bool_)
    air = _Air(true_m, true_m, true_m_s, nobody, nobody, sky.cn0_dbhz)
    for attack in attacks:
        where = attack.active(scene.time_s)[:, None] & attack.columns(sky.names)
        added_m, added_m_s = (part[:, None] for part in attack.pulled(scene.time_s))
        if attack.moved is not None:
            away, speed = attack.moved(scene, attack.start_s)
            false = _seen(scene.position_m + away, scene.velocity_m_s + speed, sky)
            added_m, added_m_s = added_m + false[0] - true_m, added_m_s + false[1] - true_m_s
        air = _with(air, attack, where, added_m, added_m_s)
    return air


def _with(
    air: _Air,
    attack: Attack,
    where: NDArray[np.bool_],
    added_m: NDArray[np.float64],
    added_m_s: NDArray[np.float64],
) -> _Air:
    """An attack more."""
    edge = np.diff(where, axis=0, prepend=where[:1]) & attack.slips
    carrier = where & (not attack.code_only)
    return _Air(
        air.code_m + np.where(where, added_m, 0.0),
        air.phase_m + np.where(carrier, added_m, 0.0),
        air.rate_m_s + np.where(carrier, added_m_s, 0.0),
        air.slipped | edge,
        air.attacked | where,
        air.cn0_dbhz + np.where(where, attack.rise_db, 0.0),
    )


def _run(
    random: np.random.Generator,
    noise: ReceiverNoise,
    clock: ClockWalk,
    air: _Air,
    scene: Scene,
) -> tuple[NDArray[np.float64], ...]:
    """Clock and its drift (E,); measured code, phase and rate in m and m/s (E, S)."""
    shape = air.code_m.shape
    interval_s = float(scene.time_s[1] - scene.time_s[0])
    offset, drift = clock.draw(random, len(scene.time_s), interval_s)
    heard = np.where(np.isfinite(air.cn0_dbhz), 0.0, np.nan)
    return (
        offset,
        drift,
        air.code_m + offset[:, None] + noise.code_m(random, shape, interval_s) + heard,
        air.phase_m + offset[:, None] + noise.phase_m(random, shape) + heard,
        air.rate_m_s + drift[:, None] + noise.doppler_m_s(random, shape) + heard,
    )
