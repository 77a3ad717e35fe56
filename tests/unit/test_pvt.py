"""Positions from observations in closed form under real ephemerides."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from observed_sky import EXACT, PLACE, VECTORS, Sky, errors, exact, navigation, part

from sdr_spoof import pvt
from sdr_spoof.errors import NavigationError
from sdr_spoof.fixes import Cause, Status
from sdr_spoof.nav.broadcast import Klobuchar
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.observations import SUBCARRIER, Observations, ObservedSignal
from sdr_spoof.positioning import reasons
from sdr_spoof.pvt import PvtConfig
from sdr_spoof.pvt.ranges import averaged

KLOBUCHAR = Klobuchar((2e-8, 1e-8, -1e-7, 0.0), (1e5, 1e5, -1e5, 0.0), "C")


@pytest.mark.parametrize("systems", ["C", "G", "CG"])
def test_exact_ranges_give_the_exact_place(systems: str) -> None:
    """Sagnac, light time, relativity, group delays and clocks all with their right signs, for
    geostationary satellites too. A delay in the receiver looks like an earlier transmission: 87 m
    of it are worth 0.2 mm of the satellite's motion.
    """
    offsets = {"G": 87.0} if "G" in systems else {}
    fixes = pvt.solve(Sky(systems, epochs=3, offsets_m=offsets).observe(), navigation(), EXACT)
    assert (fixes.status == Status.FIX).all()
    assert errors(fixes).max() < (1e-3 if offsets else 1e-5)
    assert fixes.systems == tuple(sorted(systems))
    for column, system in enumerate(fixes.systems):
        expected = 1234.5 + offsets.get(system, 0.0)
        assert fixes.clock_m[:, column] == pytest.approx(expected, abs=1e-3)
    assert fixes.used.all()
    assert not fixes.excluded


@pytest.mark.parametrize("systems", ["C", "CG"])
def test_errors_are_as_the_covariance_says(systems: str) -> None:
    count, sigma = 800, 2.0
    sky = Sky(systems, epochs=count, interval_s=0.02, sigma_m=sigma)
    config = exact(code_sigma_m=sigma, signals=("B1I",), raim_exclusions=0)
    if systems == "CG":
        config = config.model_copy(update={"signals": (), "code_sigma_m": sigma})
    observations = sky.observe()
    fixes = pvt.solve(observations, navigation(), config)
    error = fixes.position_m - PLACE
    if systems == "C":
        square = np.einsum("ei,eij,ej->e", error, np.linalg.inv(fixes.covariance_m2), error)
        # Chi-square with 3 degrees of freedom: mean 3, variance 6.
        assert square.mean() == pytest.approx(3.0, abs=4 * np.sqrt(6.0 / count))
    assert np.abs(error.mean(axis=0)).max() < 4 * np.sqrt(
        fixes.covariance_m2[0].diagonal().max() / count
    )
    assert abs(fixes.square_sum.mean() / fixes.freedom[0] - (1.0 if systems == "C" else 0.6)) < 0.4


def test_what_signals_of_a_satellite_have_in_common_counts_once() -> None:
    """Errors of the atmosphere's model: the same for both signals, larger near the horizon."""
    count, sigma, zenith = 400, 0.2, 1.0
    sky = Sky("C", {"C": ("B1I", "B1CP")}, epochs=count, interval_s=0.02)
    observations = sky.observe()
    config = exact(
        weights="elevation", code_sigma_m=sigma, zenith_sigma_m=zenith, raim_exclusions=0
    )
    look = pvt.solve(observations, navigation(), config).elevation_deg[:, ::2]
    random = np.random.default_rng(21)
    common = zenith / np.sin(np.radians(look)) * random.standard_normal(look.shape)
    ranges = observations.pseudorange_m + np.repeat(common, 2, axis=1)
    # B1C is taken for half as noisy as B1I.
    own = random.standard_normal((*look.shape, 2)) * [sigma, 0.5 * sigma]
    ranges += own.reshape(ranges.shape)
    noisy = dataclasses.replace(observations, pseudorange_m=ranges)
    fixes = pvt.solve(noisy, navigation(), config)
    error = fixes.position_m - PLACE
    square = np.einsum("ei,eij,ej->e", error, np.linalg.inv(fixes.covariance_m2), error)
    assert square.mean() == pytest.approx(3.0, abs=4 * np.sqrt(6.0 / count))
    freedom = fixes.freedom[0]
    assert fixes.square_sum.mean() == pytest.approx(freedom, abs=4 * np.sqrt(2 * freedom / count))


def test_offset_between_systems_and_signals_is_recovered() -> None:
    signals = {"C": ("B1I", "B1CP"), "G": ("L1CA",)}
    sky = Sky("CG", signals, epochs=2, offsets_m={"G": -52.5, "B1CP": 7.25})
    fixes = pvt.solve(sky.observe(), navigation(), EXACT)
    assert errors(fixes).max() < 1e-3
    assert fixes.clock_m[:, 1] - fixes.clock_m[:, 0] == pytest.approx(-52.5, abs=1e-3)
    assert fixes.biases == ("C B1I", "C B1CP", "G L1CA")
    assert fixes.bias_m[:, 1] == pytest.approx(7.25, abs=1e-3)
    assert np.isnan(fixes.bias_m[:, [0, 2]]).all()


def test_atmosphere_is_taken_out() -> None:
    data = dataclasses.replace(navigation(), ionosphere=(KLOBUCHAR,))
    sky = Sky("CG", klobuchar=KLOBUCHAR, troposphere=True, mask_deg=5.0)
    config = EXACT.model_copy(update={"ionosphere": "auto", "troposphere": "saastamoinen"})
    assert errors(pvt.solve(sky.observe(), data, config))[0] < 1e-3
    assert errors(pvt.solve(sky.observe(), data, EXACT))[0] > 5.0
    with pytest.raises(NavigationError, match="bdgim"):
        pvt.solve(sky.observe(), data, EXACT.model_copy(update={"ionosphere": "bdgim"}))


def test_blank_ionosphere_gives_way_to_what_another_system_says() -> None:
    zeros = (0.0,) * 4
    blank = dataclasses.replace(KLOBUCHAR, alpha=zeros, beta=zeros)
    other = dataclasses.replace(KLOBUCHAR, system="G")
    sky = Sky("C", klobuchar=other, troposphere=True, mask_deg=5.0)
    config = EXACT.model_copy(update={"ionosphere": "auto", "troposphere": "saastamoinen"})
    told = dataclasses.replace(navigation(), ionosphere=(other, blank))
    assert errors(pvt.solve(sky.observe(), told, config))[0] < 1e-3
    alone = pvt.solve(sky.observe(), dataclasses.replace(told, ionosphere=(blank,)), config)
    assert errors(alone)[0] > 1.0
    assert reasons.unmodelled(alone, told, config) == []
    (note,) = reasons.unmodelled(alone, dataclasses.replace(told, ionosphere=(blank,)), config)
    assert "all zero" in note
    assert reasons.unmodelled(alone, dataclasses.replace(told, ionosphere=()), config) == [note]


def test_velocity_and_drift() -> None:
    velocity = np.array([20.0, -12.0, 30.0])
    sky = Sky("CG", epochs=3, velocity=velocity, drift_m_s=299.8)
    fixes = pvt.solve(sky.observe(), navigation(), EXACT)
    assert np.abs(fixes.velocity_m_s - velocity).max() < 1e-4
    # 299.8 m in each second of a clock that is 1e-6 fast.
    assert fixes.drift_m_s == pytest.approx(299.8 * (1 + 1e-6), abs=1e-4)
    expected = PLACE + fixes.time_s[:, None] * velocity
    assert np.abs(fixes.position_m - expected).max() < 1e-4


def test_errors_of_velocity_are_as_its_covariance_says() -> None:
    count, sigma = 500, 0.1
    sky = Sky(epochs=count, interval_s=0.02, rate_sigma_m_s=sigma)
    fixes = pvt.solve(
        sky.observe(), navigation(), EXACT.model_copy(update={"doppler_sigma_m_s": sigma})
    )
    v = fixes.velocity_m_s
    square = np.einsum("ei,eij,ej->e", v, np.linalg.inv(fixes.velocity_covariance), v)
    assert square.mean() == pytest.approx(3.0, abs=4 * np.sqrt(6.0 / count))


def test_any_number_of_threads_gives_the_same_bits() -> None:
    observations = Sky("CG", epochs=50, sigma_m=3.0).observe()
    one, four = (pvt.solve(observations, navigation(), threads=n) for n in (1, 4))
    for name in ("position_m", "velocity_m_s", "clock_m", "residual_m", "cause", "square_sum"):
        assert getattr(one, name).tobytes() == getattr(four, name).tobytes()


def test_an_epoch_does_not_depend_on_the_others() -> None:
    observations = Sky(epochs=30, sigma_m=3.0).observe()
    whole = pvt.solve(observations, navigation(), EXACT)
    alone = pvt.solve(part(observations, slice(20, 30)), navigation(), EXACT)
    assert np.abs(alone.position_m - whole.position_m[20:]).max() < 1e-6


def test_smoothing_takes_noise_out_and_leaves_motion_in() -> None:
    velocity = np.array([15.0, 5.0, -20.0])
    sky = Sky(epochs=300, velocity=velocity, sigma_m=2.0)
    observations = sky.observe()
    config = EXACT.model_copy(update={"code_sigma_m": 2.0})
    rough = pvt.solve(observations, navigation(), config)
    smooth = pvt.solve(observations, navigation(), config.model_copy(update={"smoothing_s": 50.0}))
    truth = PLACE + rough.time_s[:, None] * velocity
    noise = [np.std((f.position_m - truth)[100:]) for f in (rough, smooth)]
    # White noise averaged with a memory of n epochs falls by the square root of 2 n.
    assert noise[1] < noise[0] / 5
    # What is assumed of it is the mean of n: between one and two times too much at last.
    assumed = np.sqrt(np.trace(smooth.covariance_m2[-1]) / np.trace(rough.covariance_m2[-1]))
    assert assumed == pytest.approx(1 / np.sqrt(50), rel=1e-3)
    assert smooth.covariance_m2[0] == pytest.approx(rough.covariance_m2[0])


def test_smoothing_begins_anew_after_a_slip() -> None:
    observations = Sky(epochs=60).observe()
    phase = observations.carrier_phase_cycles.copy()
    phase[30:, 1] += 1000.0
    lost = observations.lock_lost.copy()
    lost[30, 1] = True
    slipped = dataclasses.replace(observations, carrier_phase_cycles=phase, lock_lost=lost)
    config = exact(smoothing_s=20.0)
    fixes = pvt.solve(slipped, navigation(), config)
    assert errors(fixes).max() < 1e-4
    assert averaged(slipped, 20.0)[[0, 19, 29, 30, 45], 1].tolist() == [1, 20, 20, 1, 16]


def test_subcarrier_ranges_sharpen_the_fix_whatever_their_common_step() -> None:
    signals = {"C": ("B1I", "B1CP", SUBCARRIER)}
    observations = Sky("C", signals, epochs=40, sigma_m=0.3, offsets_m={SUBCARRIER: 8.1}).observe()
    beat = observations.columns(SUBCARRIER)
    exact = Sky("C", signals, epochs=40, offsets_m={SUBCARRIER: 8.1}).observe()
    step = 299_792_458.0 / 14.322e6
    ranges = observations.pseudorange_m.copy()
    random = np.random.default_rng(5)
    ranges[:, beat] = exact.pseudorange_m[:, beat] + step * random.integers(-1, 2, beat.size)
    ranges[:, beat] += 0.02 * random.standard_normal((40, beat.size))
    observations = dataclasses.replace(observations, pseudorange_m=ranges)
    codes = pvt.solve(observations, navigation(), EXACT)
    sharp = pvt.solve(observations, navigation(), EXACT.model_copy(update={"subcarrier": True}))
    assert (sharp.status == Status.FIX).all()
    assert errors(codes).mean() > 0.2
    assert errors(sharp).max() < 0.25
    assert (codes.cause[:, beat] == Cause.NOT_WANTED).all()


def test_a_real_station_is_found() -> None:
    """GEONET 0759 in 2005: C/A code alone, broadcast orbits and ionosphere."""
    vectors = VECTORS
    rows = np.loadtxt(vectors / "geonet_0759.csv", delimiter=",")
    times, prns = np.unique(rows[:, 0]), np.unique(rows[:, 1]).astype(int)
    shape = (times.size, prns.size)
    ranges, phase = np.full(shape, np.nan), np.full(shape, np.nan)
    at = (np.searchsorted(times, rows[:, 0]), np.searchsorted(prns, rows[:, 1]))
    ranges[at], phase[at] = rows[:, 2], rows[:, 3]
    no = np.zeros(shape, np.bool_)
    observations = Observations(
        reference=GnssTime.of_week(1316, times[0]),
        time_s=times - times[0],
        sample_time_s=times - times[0],
        interval_s=120.0,
        signals=tuple(ObservedSignal("G", p, "L1CA") for p in prns),
        pseudorange_m=ranges,
        carrier_phase_cycles=phase,
        doppler_hz=np.full(shape, np.nan),
        cn0_dbhz=np.full(shape, 45.0),
        lock_lost=no,
        half_cycle=no,
        spoofed=no,
    )
    config = PvtConfig(elevation_mask_deg=10.0, zenith_sigma_m=1.5, code_sigma_m=0.5)
    fixes = pvt.solve(observations, read_navigation(vectors / "geonet_0759.rnx"), config)
    truth = np.array([-3976219.5082, 3382372.5671, 3652512.9849])
    error = fixes.position_m - truth
    up = truth / np.linalg.norm(truth)
    horizontal = error - np.outer(error @ up, up)
    assert (fixes.status == Status.FIX).all()
    assert np.linalg.norm(horizontal, axis=1).mean() < 1.0
    assert np.abs(error @ up).mean() < 1.5
