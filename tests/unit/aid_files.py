"""Files of a ship in closed form for ``sdr-spoof aid``: observations and an IMU."""

from __future__ import annotations

import dataclasses

import numpy as np
import observed_sky as sky

from sdr_spoof.aiding.imu.errors import read
from sdr_spoof.aiding.imu.grades import draw
from sdr_spoof.aiding.imu.simulate import ideal_increments
from sdr_spoof.cli import main
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory

LENGTH_S = 130
TIME = np.arange(float(LENGTH_S))
ORIGIN = np.array([39.9, 116.4, 60.0])
NAV = sky.VECTORS / "brd4_2023071_04h_08h.rnx"
AS_IN_CLOSED_FORM = ("--pvt-ionosphere", "none", "--pvt-troposphere", "none")
QUICK = ("--tight-settle-s", "30", "--grade", "ship-a")


def way(time_s):
    return np.stack([8 * time_s, 60 * np.sin(time_s / 30), 0.5 * np.sin(time_s / 3)], axis=1)


SHIP = Trajectory(OnPlane(ORIGIN, way))


def clean():
    """What is observed without an attack."""
    clock = 3e4 + 20 * TIME
    at = TIME - clock / sky.LIGHT
    return sky.Sky(
        epochs=LENGTH_S,
        track=SHIP.position_m(at),
        track_velocity=SHIP.velocity_m_s(at),
        clock_m=clock,
        drift_m_s=np.full(LENGTH_S, 20.0),
        sigma_m=1.0,
        rate_sigma_m_s=0.03,
        satellites=11,
    ).observe()


def attacked():
    """The same with three satellites dragged from 80 s on, and their names."""
    made = clean()
    hit = [1, 4, 7]
    pull = 2.0 * np.clip(TIME - 80, 0, None)
    wavelength = sky.LIGHT / 1561.098e6
    ranges, phases, dopplers = (
        x.copy() for x in (made.pseudorange_m, made.carrier_phase_cycles, made.doppler_hz)
    )
    ranges[:, hit] += pull[:, None]
    phases[:, hit] += pull[:, None] / wavelength
    dopplers[80:, hit] -= 2.0 / wavelength
    seen = dataclasses.replace(
        made, pseudorange_m=ranges, carrier_phase_cycles=phases, doppler_hz=dopplers
    )
    return seen, [made.satellites[k] for k in hit]


def increments():
    """What the ship's IMU reads."""
    ideal = ideal_increments(SHIP, LENGTH_S, 100.0, reference=sky.START)
    return read(ideal, draw("ship-a", 1)[0]).log


def heading() -> str:
    """For ``--attitude``."""
    yaw = np.degrees(SHIP.attitude_rad(np.zeros(1)))[0, 0]
    return f"{yaw:.3f},0,0"


def aid(observations, imu, *more, nav=NAV):
    """Exit code of the command."""
    words = ["aid", str(observations), "--imu", str(imu), *(["--nav", str(nav)] if nav else [])]
    return main([*words, *QUICK, *AS_IN_CLOSED_FORM, *map(str, more)])
