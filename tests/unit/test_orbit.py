"""Satellite orbits and clocks against independent facts."""

from __future__ import annotations

import dataclasses
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof.errors import NavigationError
from sdr_spoof.nav.beidou_satellites import GEO
from sdr_spoof.nav.ephemeris import Ephemeris
from sdr_spoof.nav.geodesy import ecef_to_geodetic
from sdr_spoof.nav.orbit import positions, states
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.time import GnssTime

VECTORS = Path(__file__).parents[1] / "vectors/navigation"


@cache
def broadcast(name: str) -> tuple[Ephemeris, ...]:
    return read_navigation(VECTORS / name).ephemerides


def real() -> tuple[Ephemeris, ...]:
    return broadcast("brd4_2023071_04h_08h.rnx")


def by_satellite(ephemerides: tuple[Ephemeris, ...]) -> dict[tuple[str, int], list[Ephemeris]]:
    found: dict[tuple[str, int], list[Ephemeris]] = {}
    for e in sorted(ephemerides, key=lambda e: e.toe):
        found.setdefault((e.system, e.prn), []).append(e)
    return found


def test_broadcast_orbits_lie_within_metres_of_the_precise_ones() -> None:
    """IGS final orbits of 2010-07-01; what is broadcast for each instant is nearest in time."""
    rows = np.loadtxt(VECTORS / "igs15904.csv", delimiter=",")
    chosen, times = [], []
    for tow, prn in rows[:, :2]:
        time = GnssTime.of_week(1590, tow)
        own = [e for e in broadcast("brdc_2010182_00h_08h.rnx") if e.prn == prn]
        chosen.append(min(own, key=lambda e: abs(e.toe - time)))
        times.append(time)
    found = positions(chosen, times)
    miss = np.linalg.norm(found.position_m - rows[:, 2:5], axis=1)
    # The one is the antenna, the other the centre of mass: up to 2.6 m apart along the radius.
    assert np.sqrt(np.mean(miss**2)) < 3.0
    assert miss.max() < 6.0


def test_broadcast_clocks_are_the_precise_ones() -> None:
    """The precise clocks are free of the periodic relativistic part; the broadcast polynomial is
    too: so both are compared with relativity taken out of ours by its closed form."""
    rows = np.loadtxt(VECTORS / "igs15904.csv", delimiter=",")
    own = broadcast("brdc_2010182_00h_08h.rnx")
    errors = []
    for tow, prn, *_, clock_us in rows[rows[:, 5] < 9e5]:
        time = GnssTime.of_week(1590, tow)
        e = min((e for e in own if e.prn == prn), key=lambda e: abs(e.toe - time))
        state = positions(e, [time])
        # -2 r.v / c^2, with the velocity in an inertial frame: the same r.v.
        relativity = -2 * (state.position_m[0] @ state.velocity_m_s[0]) / 299_792_458.0**2
        errors.append(state.clock_s[0] - relativity - clock_us * 1e-6)
    # A common offset of the two time scales, and the broadcast clock's few ns.
    assert np.std(errors) * 299_792_458.0 < 2.0
    assert abs(np.median(errors)) < 20e-9


def test_consecutive_ephemerides_agree_between_their_times() -> None:
    misses = []
    for own in by_satellite(real()).values():
        for before, after in pairwise(own):
            gap = after.toe - before.toe
            if gap <= 7200 and before.health == after.health == 0:
                middle = before.toe + gap / 2
                at = positions([before, after], [middle, middle])
                misses.append(np.linalg.norm(at.position_m[1] - at.position_m[0]))
    assert len(misses) > 200
    assert np.median(misses) < 0.3
    assert max(misses) < 5.0


@pytest.mark.parametrize(
    ("prn", "longitude"), [(3, 110.5), (4, 160.0), (5, 58.75), (59, 140.0), (60, 80.0)]
)
def test_geostationary_satellites_stay_over_their_longitude(prn: int, longitude: float) -> None:
    """The places of BDS-SIS-ICD-B1I-3.0, section 3.1."""
    for e in by_satellite(real())["C", prn]:
        times = [e.toe + dt for dt in (-3600.0, 0.0, 3600.0)]
        place = ecef_to_geodetic(positions(e, times).position_m)
        assert np.all(np.abs(place[:, 1] - longitude) < 0.5)
        assert np.all(np.abs(place[:, 0]) < 2.0)
        assert np.all(np.abs(place[:, 2] - 35.786e6) < 110e3)


def test_orbits_have_the_radius_of_their_kind() -> None:
    for (system, prn), own in by_satellite(real()).items():
        state = positions(own, [e.toe for e in own])
        radius = np.linalg.norm(state.position_m, axis=1)
        semi_major = np.array([e.a for e in own])
        kinds = [26.56e6] if system == "G" else [42.164e6] if prn in GEO else [27.906e6, 42.16e6]
        assert min(abs(semi_major[0] - k) for k in kinds) < 60e3, (system, prn)
        assert np.all(np.abs(radius / semi_major - 1) < 0.03)


def test_velocity_is_the_derivative_of_position() -> None:
    ephemerides = [own[0] for own in by_satellite(real()).values()]
    rows = np.arange(len(ephemerides))
    reference = ephemerides[0].toe

    def at(dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        state = states(ephemerides, rows, np.full(len(rows), 900.0 + dt), reference)
        return state.position_m, state.velocity_m_s, state.clock_s

    (before, _, clock0), (_, velocity, _), (after, _, clock1) = at(-0.5), at(0.0), at(0.5)
    assert np.abs(after - before - velocity).max() < 1e-4
    drift = states(ephemerides, rows, np.full(len(rows), 900.0), reference).clock_drift
    assert np.abs(clock1 - clock0 - drift).max() < 1e-15


def test_rates_of_axis_and_motion_are_those_of_b_cnav1() -> None:
    """BDS-SIS-ICD-B1C-1.0, table 7-6: A = A0 + Adot tk; n = n0 + dn + dndot tk / 2."""
    base = by_satellite(real())["C", 30][0]
    shift, dt = 0.02, 1800.0
    moved = dataclasses.replace(base, a_dot=shift, e=0.0, crc=0.0, crs=0.0)
    still = dataclasses.replace(moved, a_dot=0.0)
    at = [base.toe + dt]
    radii = [np.linalg.norm(positions(e, at).position_m[0]) for e in (moved, still)]
    assert radii[0] - radii[1] == pytest.approx(shift * dt, rel=1e-6)
    faster = dataclasses.replace(still, delta_n_dot=1e-13)
    ahead = np.linalg.norm(positions(faster, at).position_m - positions(still, at).position_m)
    assert ahead == pytest.approx(0.5 * 1e-13 * dt**2 * base.a, rel=1e-3)


def test_any_week_and_far_reference() -> None:
    """Times are differences: weeks do not matter, and a reference days away costs nothing."""
    e = by_satellite(real())["G", 10][0]
    near = states([e], [0], [600.0], e.toe)
    far = states([e], [0], [600.0 + 5 * 86_400.0], e.toe + -5 * 86_400.0)
    assert np.abs(near.position_m - far.position_m).max() < 1e-5


def test_what_is_no_orbit_is_refused() -> None:
    e = real()[0]
    with pytest.raises(NavigationError, match="eccentricity"):
        positions(dataclasses.replace(e, e=1.5), [e.toe])
    with pytest.raises(NavigationError, match="orbit model"):
        positions(dataclasses.replace(e, system="R"), [e.toe])
    assert positions([], []).position_m.shape == (0, 3)
