"""Antenna arrays: geometry, laws of the tests, whole cycles, attitude, bad input."""

from dataclasses import replace

import numpy as np
import pytest

from sdr_spoof.aiding.array import arrival, between, motion, slips
from sdr_spoof.aiding.array.geometry import array_of, triangle
from sdr_spoof.aiding.array.phases import ArrayPhases
from sdr_spoof.aiding.array.simulate import differences, direction, towards
from sdr_spoof.errors import AidingError, ConfigError
from sdr_spoof.progress import silent
from sdr_spoof.reproduce import array as study
from sdr_spoof.reproduce.array import bearing, effects, left_out, published, track
from sdr_spoof.reproduce.study import Effort

WAVELENGTH, SIGMA, RUNS = 0.19, 0.01, 4000
ARRAY = triangle(2 * WAVELENGTH)
WAY = np.linspace(0, 1, 5)[:, None] * np.array([240.0, 30.0, 0.0])


def phases_of(unit, *, array=ARRAY, attitude=None, believed=None, way=WAY, seed=1, **more):
    attitude = np.zeros((len(way), 3)) if attitude is None else attitude
    rng = np.random.default_rng(seed)
    settings = {k: more.pop(k) for k in ("bias_cycles",) if k in more}
    known = more.get("known_cycles", True)
    measured = differences(
        array, unit, attitude, WAVELENGTH, SIGMA, rng, whole_cycles=known, **settings
    )
    believed = attitude if believed is None else believed
    time_s = np.arange(float(len(way)))
    return ArrayPhases(time_s, measured, believed, way, SIGMA, WAVELENGTH, **more)


def standing(azimuth=70.0, elevation=40.0, runs=RUNS, epochs=5):
    return np.broadcast_to(direction(azimuth, elevation), (runs, epochs, 3))


def assert_share(hits, expected, slack=0.0):
    p = float(np.mean(hits))
    assert abs(p - expected) < 4 * np.sqrt(expected * (1 - expected) / np.size(hits)) + slack


@pytest.mark.parametrize("form", motion.FORMS)
@pytest.mark.parametrize(
    "array",
    [
        ARRAY,
        array_of([(0, 0, 0), (0.4, 0, 0), (0, 0.4, 0), (0.4, 0.4, 0)]),
        array_of([(0, 0, 0), (0.4, 0, 0), (0, 0.4, 0), (0.2, 0.2, -0.3)]),
    ],
    ids=["triangle", "square", "pyramid"],
)
def test_a_satellite_alarms_as_often_as_stated(array, form):
    attitude = np.radians(np.linspace([0, 0, 0], [50, 2, -3], 5))
    values = motion.statistic(array, phases_of(standing(), array=array, attitude=attitude), form)
    assert_share(values > motion.threshold(form, 5, 0.01), 0.01)
    assert_share(motion.p_value(values, form, 5) < 0.1, 0.1)


def test_the_triangle_has_the_published_covariance():
    cov = ARRAY.covariance(SIGMA, WAVELENGTH)
    np.testing.assert_allclose(cov, 2 * SIGMA**2 / 4 * np.eye(2), atol=1e-12)


def test_without_noise_directions_come_back_whatever_the_attitude():
    attitude = np.radians([[10, 1, 2], [-140, -4, 3]])
    unit = np.broadcast_to(direction(200.0, 25.0), (1, 2, 3))
    measured = differences(ARRAY, unit, attitude, WAVELENGTH, 1e-9, np.random.default_rng(0))
    way = np.array([[0.0, 0, 0], [50, 0, 0]])
    phases = ArrayPhases(np.arange(2.0), measured, attitude, way, SIGMA, WAVELENGTH)
    found = motion.directions(ARRAY, phases)
    np.testing.assert_allclose(found.unit, unit, atol=1e-6)


def test_phases_grow_with_range():
    # A source ahead: the antenna in front is nearer, its phase smaller by the side in wavelengths.
    unit = np.broadcast_to(direction(0.0, 0.0), (1, 2, 3))
    measured = differences(
        ARRAY, unit, np.zeros((2, 3)), WAVELENGTH, 1e-12, np.random.default_rng(0)
    )
    np.testing.assert_allclose(measured[0, 0], [-2.0, -1.0], atol=1e-9)


def test_published_track_law_and_draws():
    numbers = {n.name: n for n in track.section(Effort(runs=15), silent).numbers}
    assert [n for n in numbers.values() if not n.met] == []
    assert numbers["lambda_t3"].value == pytest.approx(17.739, abs=1e-3)
    assert numbers["matched_pd_t3"].value > 0.96


def test_published_figures_and_coverage():
    section = bearing.section(Effort(runs=1), silent)
    assert [n.name for n in section.numbers if not n.met] == []
    assert len(section.numbers) == 16


def test_what_is_left_out_and_its_cures():
    section = left_out.section(Effort(runs=20), silent)
    assert [n.name for n in section.numbers if not n.met] == []
    moving = effects.satellite_motion(tuple(left_out.PFA_OF_TIME))
    # Another simulation does not say which satellite: its rates are those of one of the sky.
    others = np.array(list(left_out.PFA_OF_TIME.values()))
    assert np.all((moving.min(axis=0) < others) & (others < moving.max(axis=0)))


def test_the_study_is_registered_and_names_the_errors():
    assert len(study.STUDY.errata()) == 8
    assert study.STUDY.name == "array"


def test_a_known_orbit_takes_the_satellites_motion_away():
    path = np.stack([direction(70.0 + 0.4 * k, 40.0 + 0.3 * k) for k in range(5)])
    unit = np.broadcast_to(path, (RUNS, 5, 3))
    ignored = motion.statistic(ARRAY, phases_of(unit), "pair")
    assert np.mean(ignored > motion.threshold("pair", 2, 0.01)) > 0.3
    known = motion.statistic(ARRAY, phases_of(unit, expected=path), "pair")
    assert_share(known > motion.threshold("pair", 2, 0.01), 0.01)


def test_line_delays_are_in_the_covariance():
    attitude = np.radians(np.linspace([0, 0, 0], [90, 0, 0], 5))
    delays = 0.02 * np.random.default_rng(5).standard_normal((RUNS, 2))
    told = phases_of(standing(), attitude=attitude, bias_cycles=delays, bias_sigma_cycles=0.02)
    limit = motion.threshold("pair", 2, 0.01)
    assert_share(motion.statistic(ARRAY, told, "pair") > limit, 0.01)
    untold = replace(told, bias_sigma_cycles=0.0)
    assert np.mean(motion.statistic(ARRAY, untold, "pair") > limit) > 0.2


def test_several_transmit_antennas_are_each_seen():
    # The weakness of the double difference between satellites: every spoofed signal from its own.
    sources = np.array([[900.0, 300, -10], [800, -500, -20], [700, 600, -5]])
    unit = towards(sources, WAY)
    values = motion.statistic(ARRAY, phases_of(unit), "matched")
    assert np.all(values > motion.threshold("matched", 5, 1e-4))
    assert not between.one_source(phases_of(unit).difference_cycles[:, 0], SIGMA).any()


def test_one_transmitter_is_seen_between_satellites():
    unit = np.stack([standing(runs=1)[0], standing(runs=1)[0], standing(200.0, 50.0, 1)[0]])
    same = between.one_source(phases_of(unit).difference_cycles[:, 0], SIGMA)
    assert same.tolist() == [True, True, False]
    pairs = phases_of(standing(runs=2 * RUNS)).difference_cycles[:, 0].reshape(RUNS, 2, 2)
    assert_share(~between.one_source(pairs, SIGMA, 0.01)[:, 0], 0.01)


def test_direction_of_arrival_against_the_ephemeris():
    expected = standing(runs=1)[0]
    attitude = np.radians(np.linspace([0, 0, 0], [50, 2, -3], 5))
    clean = phases_of(standing(), attitude=attitude, expected=expected, known_cycles=False, seed=3)
    assert_share(arrival.p_value(arrival.statistic(ARRAY, clean), ARRAY) < 0.01, 0.01)
    elsewhere = phases_of(standing(75.0, 40.0), attitude=attitude, expected=expected)
    assert np.mean(arrival.p_value(arrival.statistic(ARRAY, elsewhere), ARRAY) < 0.01) > 0.99
    # Without an INS the vehicle's turn is taken for a spoofer.
    turned = arrival.fixed_attitude(ARRAY, clean)
    assert np.mean(arrival.p_value(turned[:, -1], ARRAY) < 0.01) > 0.99
    with pytest.raises(AidingError, match="ephemeris"):
        arrival.statistic(ARRAY, phases_of(standing()))


def test_yaw_noise_in_the_direction_of_arrival():
    wrong = np.zeros((RUNS, 5, 3))
    wrong[..., 0] = np.radians(1.0) * np.random.default_rng(8).standard_normal((RUNS, 1))
    phases = phases_of(
        standing(),
        attitude=wrong,
        believed=np.zeros((5, 3)),
        expected=standing(runs=1)[0],
        yaw_sigma_rad=np.radians(1.0),
    )
    values = arrival.statistic(ARRAY, phases)[:, 0]
    assert_share(arrival.p_value(values, ARRAY) < 0.01, 0.01)


def test_slips_begin_a_new_piece():
    attitude = np.radians(np.linspace([0, 0, 0], [80, 0, 0], 40))
    expected = standing(runs=1, epochs=40)[0]
    way = np.zeros((40, 3))
    measured = phases_of(expected[None], attitude=attitude, way=way).difference_cycles[0]
    assert slips.pieces(ARRAY, measured, attitude, expected, WAVELENGTH).tolist() == [0] * 40
    measured[15:, 0] += 0.5
    measured[30] = np.nan
    found = slips.pieces(ARRAY, measured, attitude, expected, WAVELENGTH)
    assert found.tolist() == [0] * 15 + [1] * 15 + [-1] + [2] * 9


def test_family_of_satellites_keeps_its_rate():
    rng = np.random.default_rng(2)
    clean = rng.random((20_000, 8))
    assert_share(motion.family(clean, 0.05).any(axis=1), 0.05)
    clean[:, 3] = 1e-9
    clean[:, 5] = np.nan
    found = motion.family(clean, 0.05)
    assert found[:, 3].all() and not found[:, 5].any()


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        ([(0, 0, 0), (1, 0, 0)], "three antennas"),
        ([(0, 0, 0), (1, 1, 0), (2, 2, 0)], "one line"),
        ([(0, 0, 0), (0, 0, 0), (0, 0, 0)], "one line"),
        ([(0, 0, 0), (1, 0, 0), (0, np.nan, 0)], "finite"),
        ([(0, 0, 0), (1, 0), (0, 1, 0)], "three numbers"),
        ("abc", "three numbers"),
    ],
)
def test_arrays_that_tell_no_direction_are_refused(elements, message):
    with pytest.raises(ConfigError, match=message):
        array_of(elements)


def test_phases_that_do_not_fit_are_refused():
    good = phases_of(standing(runs=3))
    wrong = good.difference_cycles.copy()
    wrong[0, 0, 0] = np.nan
    for change, message in (
        ({"time_s": good.time_s[::-1]}, "ascending"),
        ({"time_s": good.time_s[:1]}, "two epochs"),
        ({"attitude_rad": good.attitude_rad[:2]}, "attitudes are of shape"),
        ({"displacement_m": good.displacement_m[:2]}, "displacements are of shape"),
        ({"expected": good.attitude_rad[:2]}, "expected directions"),
        ({"difference_cycles": wrong}, "not a number"),
        ({"sigma_cycles": 0.0}, "above 0"),
    ):
        with pytest.raises(AidingError, match=message):
            replace(good, **change)


def test_phases_of_no_plane_wave_give_no_statistic():
    phases = phases_of(standing(runs=1), known_cycles=False)
    measured = phases.difference_cycles + 1e3 * np.arange(5.0)[:, None]
    values = motion.statistic(ARRAY, replace(phases, difference_cycles=measured), "matched")
    assert np.isnan(values).all()
    assert published.needed(0.9) == pytest.approx(17.43, abs=0.01)
