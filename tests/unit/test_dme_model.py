"""Measurement model of INS, GNSS and DME: geometry, spoofing, feedback, linear statistics."""

import numpy as np
import pytest

from sdr_spoof.aiding.dme import integrity
from sdr_spoof.aiding.dme.feedback import Feedback
from sdr_spoof.aiding.dme.geometry import Geometry, directions, pdop
from sdr_spoof.aiding.dme.isolation import isolate
from sdr_spoof.aiding.dme.model import simulate
from sdr_spoof.aiding.dme.spoofing import clock_only, coherent, ramp, step
from sdr_spoof.aiding.dme.stations import Station, sigma_m, slant_ranges_m
from sdr_spoof.aiding.dme.statistics import STATISTICS, find
from sdr_spoof.aiding.simulated import fixed
from sdr_spoof.errors import AidingError, ConfigError
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.reproduce.sprt_dme import published

SEVEN = ((20, 72), (70, 36), (150, 42), (230, 34), (310, 47), (100, 60), (275, 15))


def rng(seed=1):
    return np.random.default_rng(seed)


def made(sigma=3.0, sky=SEVEN):
    return Geometry.of(directions(sky), sigma, directions([(40, -7), (130, -6)]), (183.0, 183.0))


def test_annex_10_noise():
    np.testing.assert_allclose(sigma_m([1e3, 80e3, 100e3, 150e3]), [182.6] * 3 + [209.1], atol=0.05)


def test_slant_ranges():
    station = Station("A", 34.0, 108.0, 400.0)
    above = geodetic_to_ecef(np.array([34.0, 108.0, 10_400.0]))
    np.testing.assert_allclose(slant_ranges_m((station,), above), [10_000.0], atol=1e-6)


def test_the_reference_geometry_has_its_numbers():
    geometry = published.geometry(10.0)
    assert pdop(geometry) == pytest.approx(3.9, abs=0.05)
    hat = np.diag(geometry.without_stations().hat())
    np.testing.assert_allclose(hat, [0.860, 0.952, 0.733, 0.768, 0.688], atol=1e-3)


def test_geometry_of_places_is_that_of_directions():
    place = geodetic_to_ecef(np.array([34.0, 108.0, 10_000.0]))
    seen = fixed(np.zeros(1), place, SEVEN).position_m[0]
    seen = np.vstack([seen, np.full((1, 3), np.nan)])
    stations = (Station("A", 34.6, 108.4, 400.0), Station("B", 33.6, 109.0, 500.0))
    geometry = Geometry.at(place, seen, 3.0, stations)
    np.testing.assert_allclose(geometry.design[:7], made().design[:7], atol=1e-9)
    assert geometry.stations == 2
    # 76 and 103 km away.
    np.testing.assert_allclose(geometry.sigma_m[-2:], [182.6, 182.6], atol=0.1)
    north_east = -geometry.design[7, :2]
    bearing = np.degrees(np.arctan2(*north_east))
    assert bearing == pytest.approx(28.7, abs=0.5)
    assert Geometry.at(place, seen, 3.0).stations == 0


@pytest.mark.parametrize("name", STATISTICS)
def test_channels_are_standard_normal_without_an_attack(name):
    geometry = made()
    y = simulate(geometry, 50, 400, rng()).differences_m
    z = STATISTICS[name].values(y, geometry)
    z = z[..., ~np.isnan(z).all(axis=(0, 1))]
    count = z[..., 0].size
    np.testing.assert_allclose(z.mean(axis=(0, 1)), 0.0, atol=4.5 / count**0.5)
    np.testing.assert_allclose(z.std(axis=(0, 1)), 1.0, atol=4.5 / (2 * count) ** 0.5)


def test_what_each_statistic_is_blind_to():
    geometry = made()

    def shift(name, spoofing, error=(0.0, 0.0, 0.0)):
        b = np.zeros(len(geometry.sigma_m))
        b[: geometry.satellites] = -spoofing(np.array([10.0]), geometry)[0]
        weights = STATISTICS[name].weights(geometry)
        return float(np.abs(weights @ (b + geometry.design[:, :3] @ np.array(error))).max())

    along = (30.0, -40.0, 0.0)
    false = coherent(along, 5.0, 0.0)
    clock = clock_only(20.0, 1.0, 5.0)
    captured = tuple(float(v) for v in along)
    assert shift("parity", clock) < 1e-9
    assert shift("difference-clock-free", clock) < 1e-9
    assert shift("fitted", clock) > 5.0
    # A captured INS: the satellites say nothing, DME does.
    assert shift("fitted", false, captured) < 0.01
    assert shift("difference", false, captured) < 1e-9
    satellites = geometry.without_stations()
    b = -false(np.array([10.0]), geometry)[0]
    assert np.abs(STATISTICS["parity"].weights(satellites) @ b).max() < 1e-9
    assert shift("dme-difference", false, captured) > 0.1
    design = geometry.design[-2:, :3]
    across = np.cross(design[0] - design[1], [0.0, 0.0, 1.0])
    assert shift("dme-difference", clock, tuple(100.0 * across)) < 1e-9


def test_kinds_of_spoofing():
    geometry, times = made(), np.array([0.0, 9.0, 10.0, 12.0])
    assert step([1], 5.0, 10.0)(times, geometry)[:, 1].tolist() == [0.0, 0.0, 5.0, 5.0]
    assert ramp([0, 2], 0.5, 10.0)(times, geometry)[:, 2].tolist() == [0.0, 0.0, 0.0, 1.0]
    assert not ramp([0, 2], 0.5, 10.0)(times, geometry)[:, 1].any()
    assert clock_only(3.0, 1.0, 10.0)(times, geometry)[:, 4].tolist() == [0.0, 0.0, 3.0, 5.0]
    moved = coherent((0.0, 0.0, 2.0), 1.0, 10.0)(times, geometry)[-1]
    # Up by 2 m: nearer to every satellite by the sine of its elevation.
    wanted = [-2.0 * np.sin(np.radians(e)) for _, e in SEVEN]
    np.testing.assert_allclose(moved, wanted, atol=1e-12)


@pytest.mark.parametrize(("kind", "lag_m"), [("loose", 20.0), ("velocity", 0.0)])
def test_a_captured_ins_follows_a_drag(kind, lag_m):
    geometry = made()
    run = simulate(
        geometry,
        200,
        1,
        rng(),
        spoofing=coherent((1.0, 0.0, 0.0), 2.0, 0.0),
        feedback=Feedback(kind, 10.0, noisy=False),
    )
    behind = 2.0 * run.time_s[-1] - run.error_m[0, -1, 0]
    # First order lags by the speed times the time constant, and an epoch.
    assert behind == pytest.approx(lag_m, abs=2.1)


def test_feedback_tight_and_none():
    geometry = made()
    spoofing = step([0], 50.0, 0.0)
    tight = simulate(
        geometry, 400, 1, rng(), spoofing=spoofing, feedback=Feedback("tight", 10.0, noisy=False)
    )
    fix = geometry.without_stations().estimator()[:3]
    b = spoofing(np.zeros(1), geometry)[0]
    np.testing.assert_allclose(tight.error_m[0, -1], fix @ b, atol=0.2)
    free = simulate(geometry, 11, 2, rng(), spoofing=spoofing, drift_m_s=(1.0, 0.0, -0.5))
    np.testing.assert_allclose(free.error_m[1, -1], [10.0, 0.0, -5.0])
    with pytest.raises(ConfigError, match="feedback"):
        Feedback("deep")


def test_bad_geometry_is_said():
    few = Geometry.of(directions(SEVEN[:3]), 3.0)
    with pytest.raises(AidingError, match="3 satellites cannot determine 4"):
        few.estimator()
    one = Geometry.of(directions(SEVEN), 3.0, directions([(40, -7)]), (183.0,))
    with pytest.raises(AidingError, match="two are needed"):
        STATISTICS["dme-difference"].weights(one)
    line = Geometry.of(directions(SEVEN), 3.0, directions([(40, -7), (42, -5)]), (183.0, 183.0))
    with pytest.raises(AidingError, match="in line"):
        STATISTICS["dme-difference"].weights(line)
    cone = Geometry.of(directions([(a, 45) for a in (0, 60, 120, 180, 240, 300)]), 3.0)
    with pytest.raises(AidingError, match="cannot be determined"):
        cone.estimator()
    with pytest.raises(AidingError, match="nothing is left"):
        STATISTICS["parity"].weights(Geometry.of(directions(SEVEN[:4]), 3.0))
    with pytest.raises(ConfigError, match="unknown statistic"):
        find("magic")


def test_raim_false_alarms_and_exclusion():
    geometry = made(sky=SEVEN)
    y = simulate(geometry, 100, 500, rng(3)).differences_m
    for test in (integrity.raim, integrity.aaim):
        share = float(test(y, geometry, 1e-2).alarmed.mean())
        assert share == pytest.approx(1e-2, abs=4 * (1e-2 / 50_000) ** 0.5)
    y[..., 2] -= 60.0
    found = integrity.raim(y, geometry, 1e-5)
    assert found.alarmed.mean() > 0.99
    assert (found.excluded[found.alarmed] == 2).mean() > 0.9


@pytest.mark.parametrize("spoofed", [(2,), (0, 4), (1, 3, 5)])
def test_isolation_names_the_satellites_and_mends_the_position(spoofed):
    geometry = made()
    sizes = dict(zip(spoofed, (40.0, 25.0, -30.0), strict=False))
    y = geometry.sigma_m * rng(4).standard_normal((30, 9))
    for j, size in sizes.items():
        y[:, j] -= size
    found = isolate(y.mean(axis=0), geometry, 30)
    assert found.satellites == spoofed
    assert found.unique
    assert np.linalg.norm(found.after_m) < 5.0 < np.linalg.norm(found.before_m)


def test_isolation_of_nothing_of_a_clock_and_of_a_captured_ins():
    geometry = made()
    y = geometry.sigma_m * rng(5).standard_normal((30, 9))
    assert isolate(y.mean(axis=0), geometry, 30).satellites == ()
    y[:, :7] -= 100.0
    assert isolate(y.mean(axis=0), geometry, 30).satellites == ()
    # An INS that is off by 200 m: with it all disagree, without it none.
    y += geometry.design[:, :3] @ np.array([200.0, 0.0, 0.0])
    assert isolate(y.mean(axis=0), geometry, 30, trusted=False).satellites == ()
    y[:, 3] -= 50.0
    assert isolate(y.mean(axis=0), geometry, 30, trusted=False).satellites == (3,)
    y[0, :6] = np.nan
    assert isolate(y[0], geometry).after_m is None
