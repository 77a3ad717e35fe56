"""Effects that the publication leaves out, drawn: whole cycles, tilt, yaw, moving satellites.

Satellites are drawn evenly over the sky above 10 degrees, spoofers evenly over the half sphere at
1.7 km; the vehicle goes 242 m, as to t5.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.aiding.array import motion
from sdr_spoof.aiding.array.simulate import direction, towards
from sdr_spoof.nav.geodesy import azimuth_elevation
from sdr_spoof.nav.orbit import positions
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.scenario.sky.orbits import DEFAULT

from . import published

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sdr_spoof.aiding.array.config import Form
    from sdr_spoof.nav.ephemeris import Ephemeris

    Floats = NDArray[np.float64]

SEED = 20_170_009
MOVED = np.array([[0.0, 0.0, 0.0], [242.0, 0.0, 0.0]])
SPOOFER_M = 1700.0
LOWEST_DEG = 10.0
TILT_ELEVATION_DEG, YAW_ELEVATION_DEG = 51.0, 30.0


@dataclass(frozen=True)
class Turned:
    """Rates with unknown whole cycles and a turn between the epochs."""

    turn_deg: float
    ignored_pfa: float
    """Of the published test, which knows of no whole cycles."""
    pair_pfa: float
    pair_pd: float
    matched_pfa: float
    matched_pd: float


@dataclass(frozen=True)
class Wrong:
    """Pfa with an error of the attitude between the epochs."""

    kind: str
    error_deg: float
    published_pfa: float
    cured_pfa: float


@dataclass(frozen=True)
class Together:
    """Rates of one form with all effects at once, and its clean statistics."""

    pfa: float
    pd: float
    clean: Floats


def _sky(rng: np.random.Generator, runs: int, lowest_deg: float = LOWEST_DEG) -> Floats:
    """Directions spread evenly over the sky, (runs, 3)."""
    height = rng.uniform(np.sin(np.radians(lowest_deg)), 1.0, runs)
    turn = rng.uniform(0, 2 * np.pi, runs)
    level = np.sqrt(1 - height**2)
    return np.stack([level * np.cos(turn), level * np.sin(turn), -height], axis=-1)


def _still(unit: Floats) -> Floats:
    """The same direction at both epochs."""
    return np.repeat(unit[..., None, :], 2, axis=-2)


def _share(unit: Floats, form: Form, rng: np.random.Generator, **settings: object) -> float:
    values = _values(unit, form, rng, **settings)
    return float(np.mean(values > motion.threshold(form, 2, published.PFA)))


def _values(unit: Floats, form: Form, rng: np.random.Generator, **settings: object) -> Floats:
    phases = published.measured(unit, MOVED, rng, **settings)  # type: ignore[arg-type]
    return motion.statistic(published.ARRAY, phases, form)


def _attitude(yaw_deg: float = 0.0, roll_deg: float = 0.0) -> Floats:
    """Level to the north, then turned."""
    return np.radians([[0.0, 0.0, 0.0], [yaw_deg, 0.0, roll_deg]])


def turned(turn_deg: float, runs: int) -> Turned:
    """Both forms on satellites and spoofers; the pair also as if there were no whole cycles."""
    rng = np.random.default_rng((SEED, round(turn_deg)))
    satellites = _still(_sky(rng, runs))
    spoofers = towards(SPOOFER_M * _sky(rng, runs, 0.0), MOVED)
    attitude = _attitude(turn_deg)
    ignored = published.measured(satellites, MOVED, rng, attitude=attitude, known_cycles=False)
    plain = motion.statistic(published.ARRAY, replace(ignored, known_cycles=True), "pair")
    shares = [
        _share(unit, form, rng, attitude=attitude, known_cycles=False)
        for form in ("pair", "matched")
        for unit in (satellites, spoofers)
    ]
    return Turned(turn_deg, float(np.mean(plain > published.THRESHOLD)), *shares)


def tilted(tilt_deg: float, runs: int) -> Wrong:
    """A change of roll that the published test ignores and the INS knows."""
    rng = np.random.default_rng((SEED, 2, round(tilt_deg)))
    bearings = rng.uniform(0, 360, runs)
    unit = _still(direction(bearings, TILT_ELEVATION_DEG))
    attitude = _attitude(0.0, tilt_deg)
    ignored = _share(unit, "pair", rng, attitude=attitude, believed=_attitude())
    return Wrong("tilt", tilt_deg, ignored, _share(unit, "pair", rng, attitude=attitude))


def misled(yaw_deg: float, runs: int) -> Wrong:
    """An error of yaw of that size; and one of that sigma of which the test is told."""
    rng = np.random.default_rng((SEED, 3, round(10 * yaw_deg)))
    unit = _still(np.broadcast_to(direction(20.0, YAW_ELEVATION_DEG), (runs, 3)))
    ignored = _share(unit, "pair", rng, attitude=_attitude(yaw_deg), believed=_attitude())
    sigma = float(np.radians(yaw_deg))
    drawn = np.zeros((runs, 2, 3))
    drawn[:, 1, 0] = sigma * rng.standard_normal(runs)
    told = {"attitude": drawn, "believed": _attitude(), "yaw_sigma_rad": sigma}
    return Wrong("yaw", yaw_deg, ignored, _share(unit, "pair", rng, **told))


def satellite_motion(times_s: Sequence[float]) -> Floats:
    """Pfa of the published test by the satellites' own motion, (satellites, times), by the law."""
    receiver = 1e3 * np.asarray(published.ANTENNA_KM[0])
    found = []
    for ephemeris in read_navigation(DEFAULT).ephemerides:
        if ephemeris.system == "G":
            looks = _looks(ephemeris, receiver, times_s)
            if -looks[0, 2] > np.sin(np.radians(LOWEST_DEG)):
                found.append(published.detected(published.noncentrality(looks[0], looks[1:])))
    return np.array(found)


def _looks(ephemeris: Ephemeris, receiver: Floats, times_s: Sequence[float]) -> Floats:
    """Directions at the ephemeris's reference time and each of the times later, (T + 1, 3)."""
    times = [ephemeris.toe + t for t in (0.0, *times_s)]
    places = positions(ephemeris, times).position_m
    return direction(*azimuth_elevation(receiver, places).T)


def together(runs: int) -> dict[Form, Together]:
    """Pfa, Pd and clean statistics with a turn, a tilt, wrong yaw and unknown cycles together."""
    rng = np.random.default_rng((SEED, 4))
    believed = _attitude(30.0, 1.0)
    true = np.broadcast_to(believed, (runs, 2, 3)).copy()
    true[:, 1, 0] += np.radians(0.5) * rng.standard_normal(runs)
    settings = {
        "attitude": true,
        "believed": believed,
        "known_cycles": False,
        "yaw_sigma_rad": float(np.radians(0.5)),
    }
    satellites = _still(_sky(rng, runs))
    spoofers = towards(SPOOFER_M * _sky(rng, runs, 0.0), MOVED)
    found: dict[Form, Together] = {}
    for form in ("pair", "matched"):
        clean = _values(satellites, form, rng, **settings)
        limit = motion.threshold(form, 2, published.PFA)
        pd = _share(spoofers, form, rng, **settings)
        found[form] = Together(float(np.mean(clean > limit)), pd, clean)
    return found
