"""Measurements for a filter from observations in closed form."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from observed_sky import EXACT, LIGHT, PLACE, START, Sky, navigation

from sdr_spoof.aiding import measurements
from sdr_spoof.errors import AidingError
from sdr_spoof.nav.broadcast import Klobuchar
from sdr_spoof.nav.geodesy import enu_matrix
from sdr_spoof.observations import SUBCARRIER
from sdr_spoof.pvt import PvtConfig

AIR = Klobuchar((2e-8, 1.5e-8, -6e-8, -1.2e-7), (1.2e5, 1e5, -1.3e5, -4e5), "C")
EPOCHS = 40
TIME = np.arange(EPOCHS) * 1.0
DRIFT = 240.0
"""0.8 ppm, m/s."""


def circle(time_s):
    """50 m/s, once around in a minute."""
    east, north = np.array(enu_matrix(39.9, 116.4))[:2]
    angle, rate = 2 * np.pi * time_s[:, None] / 60, 2 * np.pi / 60
    radius = 50 / rate
    where = PLACE + radius * (np.sin(angle) * east + np.cos(angle) * north)
    return where, radius * rate * (np.cos(angle) * east - np.sin(angle) * north)


def errors(seen, found, places, velocities, clock_m, drift_m_s):
    """Of ranges, rates and changes, the receiver's clock taken off."""
    way = found.satellite_m - places[:, None]
    distance = np.linalg.norm(way, axis=-1)
    towards = found.satellite_velocity_m_s - velocities[:, None]
    rate = np.einsum("esx,esx->es", way, towards) / distance
    left = found.range_m - distance - clock_m[:, None]
    change = found.change_m - np.diff(distance + clock_m[:, None], axis=0, prepend=np.nan)
    return left, found.rate_m_s - rate - drift_m_s, change


def test_what_is_left_is_geometry_and_clock():
    clock = 3e5 + DRIFT * TIME
    # By receiver time the antenna is where it was at the system time of that instant.
    track, speed = circle(TIME - clock / LIGHT)
    sky = Sky(
        "CG",
        epochs=EPOCHS,
        track=track,
        track_velocity=speed,
        clock_m=clock,
        drift_m_s=np.full(EPOCHS, DRIFT),
    )
    seen = sky.observe()
    found = measurements.of(seen, navigation(), EXACT)
    np.testing.assert_allclose(found.time_s, TIME - clock / LIGHT, atol=1e-9)
    left, rate, change = errors(seen, found, track, speed, clock, DRIFT / (1 - DRIFT / LIGHT))
    assert left.shape[1] > 15
    assert np.abs(left).max() < 2e-3
    # The closed form's own steps of 0.05 s leave 2e-4 m/s on this circle.
    assert np.abs(rate).max() < 1e-3
    assert np.isnan(change[0]).all() and np.abs(change[1:]).max() < 1e-3
    assert set(found.systems) == {"C", "G"} and found.reference == START


def test_the_atmosphere_is_taken_off():
    """The closed form delays its carrier as its code: what is left of changes is twice the air."""
    sky = Sky(epochs=EPOCHS, clock_m=100.0, klobuchar=AIR, troposphere=True)
    seen = sky.observe()
    contents = dataclasses.replace(navigation(), ionosphere=(AIR,))
    config = PvtConfig(ionosphere="klobuchar")
    found = measurements.of(seen, contents, config)
    still = np.broadcast_to(PLACE, (EPOCHS, 3))
    clock = np.full(EPOCHS, 100.0)
    left, rate, change = errors(seen, found, still, 0 * still, clock, 0.0)
    assert np.abs(left).max() < 0.01
    without = measurements.of(seen, contents, config.model_copy(update={"ionosphere": "none"}))
    ionosphere = without.range_m - found.range_m
    assert ionosphere.min() > 1.0
    twice = 2 * np.diff(ionosphere, axis=0)
    np.testing.assert_allclose(change[1:], twice, atol=1e-4)
    np.testing.assert_allclose(rate[1:], twice, atol=2e-4)


def test_one_signal_of_each_satellite_and_no_bias_between_them():
    """B1C where there is one, B1I where there is not; 7 m between them in the receiver."""
    sky = Sky(signals={"C": ("B1I", "B1CP")}, epochs=3, offsets_m={"B1CP": 7.0}, satellites=8)
    both = sky.observe()
    pseudorange = both.pseudorange_m.copy()
    first = both.satellites[0]
    gone = [k for k, s in enumerate(both.signals) if (s.satellite, s.signal) == (first, "B1CP")]
    pseudorange[:, gone] = np.nan
    seen = dataclasses.replace(both, pseudorange_m=pseudorange)
    found = measurements.of(seen, navigation(), EXACT)
    assert found.satellites == both.satellites
    still = np.broadcast_to(PLACE, (3, 3))
    left, *_ = errors(seen, found, still, 0 * still, np.full(3, 1234.5), 0.0)
    assert np.abs(left).max() < 2e-3
    own = [s.signal for s in both.signals if s.satellite == first]
    assert own == ["B1I", "B1CP"]
    assert all(s.signal != SUBCARRIER for s in both.signals)


def test_slips_gaps_and_new_orbits_break_the_phase():
    seen = Sky(epochs=6, satellites=8).observe()
    lost = seen.lock_lost.copy()
    lost[3, 0] = True
    phase = seen.carrier_phase_cycles.copy()
    phase[4, 1] = np.nan
    found = measurements.of(
        dataclasses.replace(seen, lock_lost=lost, carrier_phase_cycles=phase), navigation(), EXACT
    )
    nan = np.isnan(found.change_m)
    assert np.flatnonzero(nan[:, 0]).tolist() == [0, 3]
    assert np.flatnonzero(nan[:, 1]).tolist() == [0, 4, 5]
    assert np.flatnonzero(nan[:, 2]).tolist() == [0]
    late = dataclasses.replace(seen, time_s=seen.time_s + np.array([0, 0, 0, 5, 5, 5]))
    later = measurements.of(late, navigation(), EXACT)
    assert np.isnan(later.change_m[3]).all() and np.isfinite(later.change_m[4]).all()


def test_spoofed_satellites_stay_and_are_named():
    seen = Sky(epochs=4, satellites=8).observe()
    spoofed = seen.spoofed.copy()
    spoofed[2:, 1] = True
    ranges = seen.pseudorange_m.copy()
    ranges[2:, 1] += 300.0
    hit = dataclasses.replace(seen, spoofed=spoofed, pseudorange_m=ranges)
    found = measurements.of(hit, navigation(), EXACT)
    clean = measurements.of(seen, navigation(), EXACT)
    np.testing.assert_array_equal(found.spoofed, spoofed)
    away = found.range_m - clean.range_m
    np.testing.assert_allclose(away[2:, 1], 300.0, atol=0.01)
    assert np.abs(np.delete(away, 1, axis=1)).max() < 1e-3


def test_weak_and_low_signals_are_none():
    seen = Sky(epochs=2, mask_deg=2.0).observe()
    cn0 = seen.cn0_dbhz.copy()
    cn0[1, 0] = 20.0
    config = EXACT.model_copy(update={"elevation_mask_deg": 15.0})
    found = measurements.of(dataclasses.replace(seen, cn0_dbhz=cn0), navigation(), config)
    assert np.isnan(found.range_m[1, 0]) and np.isnan(found.cn0_dbhz[1, 0])
    place = np.broadcast_to(PLACE, (2, 3))
    up = (found.satellite_m - place[:, None]) @ enu_matrix(39.9, 116.4)[2]
    height = np.degrees(np.arcsin(up / np.linalg.norm(found.satellite_m - PLACE, axis=-1)))
    assert np.nanmin(height) > 15.0 and np.isnan(height).any()


def test_epochs_without_a_fix_borrow_the_place_of_their_neighbours():
    seen = Sky(epochs=7, satellites=6).observe()
    ranges = seen.pseudorange_m.copy()
    ranges[3:5, 3:] = np.nan
    found = measurements.of(dataclasses.replace(seen, pseudorange_m=ranges), navigation(), EXACT)
    still = np.broadcast_to(PLACE, (7, 3))
    left, *_ = errors(seen, found, still, 0 * still, np.full(7, 1234.5), 0.0)
    assert np.isfinite(left[3:5, :3]).all() and np.nanmax(np.abs(left)) < 2e-3


def test_without_any_position_it_says_so():
    seen = Sky(epochs=2, satellites=3).observe()
    with pytest.raises(AidingError, match=r"no epoch has a position.*too few satellites"):
        measurements.of(seen, navigation(), EXACT)
