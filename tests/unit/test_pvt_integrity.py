"""What positioning leaves out, what it doubts, and what it says of it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from observed_sky import EXACT, PLACE, START, Sky, errors, exact, navigation, part

from sdr_spoof import pvt
from sdr_spoof.fixes import Cause, Status
from sdr_spoof.nav.records import Navigation
from sdr_spoof.observations import Observations, ObservedSignal


def test_false_alarms_of_raim_are_as_configured() -> None:
    count, sigma = 1500, 1.0
    config = exact(code_sigma_m=sigma, raim_false_alarm=0.02, raim_exclusions=0)
    observations = Sky(epochs=count, interval_s=0.01, sigma_m=sigma).observe()
    fixes = pvt.solve(observations, navigation(), config)
    suspects = (fixes.status == Status.SUSPECT).sum()
    assert abs(suspects - 0.02 * count) < 4 * np.sqrt(0.02 * count)
    freedom = int(fixes.freedom[0])
    assert freedom == len(observations.signals) - 4
    assert fixes.square_sum.mean() == pytest.approx(freedom, abs=4 * np.sqrt(2 * freedom / count))


def test_one_false_satellite_is_excluded_and_named() -> None:
    observations = Sky("CG", satellites=5, epochs=20, sigma_m=0.5).observe()
    for column, signal in enumerate(observations.signals):
        ranges = observations.pseudorange_m.copy()
        ranges[:, column] += 100.0
        biased = dataclasses.replace(observations, pseudorange_m=ranges)
        fixes = pvt.solve(biased, navigation(), EXACT.model_copy(update={"code_sigma_m": 0.5}))
        assert (fixes.status == Status.FIX).all()
        assert (fixes.cause[:, column] == Cause.RESIDUAL).all()
        assert [(e.satellite, e.epochs) for e in fixes.excluded] == [(signal.satellite, 20)]
        error = fixes.position_m - PLACE
        square = np.einsum("ei,eij,ej->e", error, np.linalg.inv(fixes.covariance_m2), error)
        assert square.mean() < 3.0 + 4 * np.sqrt(6.0 / 20)


def test_a_satellite_is_excluded_with_all_its_signals() -> None:
    signals = {"C": ("B1I", "B1CP")}
    observations = Sky("C", signals, satellites=7, sigma_m=0.3).observe()
    ranges = observations.pseudorange_m.copy()
    ranges[:, 2:4] += 60.0
    fixes = pvt.solve(dataclasses.replace(observations, pseudorange_m=ranges), navigation(), EXACT)
    assert (fixes.cause[:, 2:4] == Cause.RESIDUAL).all()
    assert (fixes.status == Status.FIX).all()


def test_what_cannot_be_told_apart_is_suspect() -> None:
    """With five satellites a false one shows, but not which it is."""
    observations = Sky(satellites=5).observe()
    observations.pseudorange_m[:, 1] += 200.0
    fixes = pvt.solve(observations, navigation(), EXACT)
    assert fixes.status[0] == Status.SUSPECT
    assert fixes.used.all()


def test_four_satellites_are_not_checked_and_three_give_no_fix() -> None:
    four = pvt.solve(Sky(satellites=4).observe(), navigation(), EXACT)
    assert four.status[0] == Status.UNCHECKED
    assert errors(four)[0] < 1e-5
    three = pvt.solve(Sky(satellites=3).observe(), navigation(), EXACT)
    assert three.status[0] == Status.NO_FIX
    assert np.isnan(three.position_m).all()
    assert three.reason(0) == "too few satellites: 3 usable before the elevation mask"
    assert {e.cause for e in three.excluded} == {Cause.NO_FIX}


def test_two_systems_need_five() -> None:
    observations = Sky("CG", satellites=2).observe()
    assert pvt.solve(observations, navigation(), EXACT).status[0] == Status.NO_FIX
    more = Sky("CG", satellites=3).observe()
    assert pvt.solve(more, navigation(), EXACT).status[0] == Status.FIX


def test_two_signals_of_four_satellites_check_nothing() -> None:
    observations = Sky("C", {"C": ("B1I", "B1CP")}, satellites=4).observe()
    assert pvt.solve(observations, navigation(), EXACT).status[0] == Status.UNCHECKED


def test_spoofed_satellites_are_left_out_and_named() -> None:
    observations = Sky(epochs=4).observe()
    spoofed = observations.spoofed.copy()
    spoofed[2:, 3] = True
    ranges = observations.pseudorange_m.copy()
    ranges[2:, 3] += 40.0
    marked = dataclasses.replace(observations, spoofed=spoofed, pseudorange_m=ranges)
    fixes = pvt.solve(marked, navigation(), EXACT)
    assert errors(fixes).max() < 1e-5
    name = observations.signals[3].satellite
    assert [fixes.spoofed(e) for e in range(4)] == [(), (), (name,), (name,)]
    assert [str(e) for e in fixes.excluded] == [f"{name} B1I: spoofed"]


def cause_of(fixes, satellite: str) -> Cause:
    column = [s.satellite for s in fixes.signals].index(satellite)
    return Cause(int(fixes.cause[0, column]))


def a_satellite(observations: Observations) -> ObservedSignal:
    return next(s for s in observations.signals if s.prn > 18)


def test_unhealthy_stale_and_unknown_satellites_are_left_out() -> None:
    observations = Sky().observe()
    signal = a_satellite(observations)

    def changed(**changes) -> Navigation:
        own = (signal.system, signal.prn)
        known = navigation().ephemerides
        if not changes:
            return Navigation(ephemerides=tuple(e for e in known if (e.system, e.prn) != own))
        edited = [
            dataclasses.replace(e, **changes) if (e.system, e.prn) == own else e for e in known
        ]
        return Navigation(ephemerides=tuple(edited))

    for navigation_data, cause in [
        (changed(health=1), Cause.UNHEALTHY),
        (changed(fit_interval_s=0.0, toe=START + -7000.0), Cause.STALE),
        (changed(), Cause.NO_EPHEMERIS),
    ]:
        fixes = pvt.solve(observations, navigation_data, EXACT)
        assert cause_of(fixes, signal.satellite) == cause
        assert fixes.status[0] == Status.FIX
        assert errors(fixes)[0] < 1e-5


def test_old_ephemerides_give_no_fix_rather_than_a_wrong_one() -> None:
    observations = dataclasses.replace(Sky().observe(), reference=START + 86_400.0 * 3)
    fixes = pvt.solve(observations, navigation(), EXACT)
    assert fixes.status[0] == Status.NO_FIX
    assert {e.cause for e in fixes.excluded} == {Cause.STALE}


def test_weak_low_and_unwanted_signals_are_left_out() -> None:
    observations = Sky("C", {"C": ("B1I", "B1CP")}, mask_deg=3.0).observe()
    observations.cn0_dbhz[:, 4] = 20.0
    config = exact(signals=("B1I",), elevation_mask_deg=20.0)
    fixes = pvt.solve(observations, navigation(), config)
    assert fixes.cause[0, 4] == Cause.WEAK
    assert (fixes.cause[0, 1::2] == Cause.NOT_WANTED).all()
    low = fixes.elevation_deg[0] < 20.0
    assert low[::2].sum() > 2
    assert set(fixes.cause[0, ::2][low[::2]].tolist()) <= {Cause.LOW, Cause.WEAK}
    assert not (fixes.cause[0, ~low] == Cause.LOW).any()
    assert errors(fixes)[0] < 1e-5


def test_nothing_observed_is_nothing_found() -> None:
    observations = Sky(epochs=5).observe()
    observations.pseudorange_m[1] = np.nan
    observations.pseudorange_m[3, 2:] = np.nan
    fixes = pvt.solve(observations, navigation(), EXACT)
    assert fixes.status.tolist() == [1, 0, 1, 0, 1]
    assert fixes.reason(1) == "too few satellites: 0 usable before the elevation mask"
    assert pvt.solve(part(observations, slice(0, 0)), navigation(), EXACT).epochs == 0


def test_a_wrong_ephemeris_is_a_false_satellite() -> None:
    """Three kilometres off along its orbit: healthy, fresh, and not believed."""
    observations = Sky().observe()
    signal = a_satellite(observations)
    own = (signal.system, signal.prn)
    wrong = tuple(
        dataclasses.replace(e, m0=e.m0 + 1e-4) if (e.system, e.prn) == own else e
        for e in navigation().ephemerides
    )
    fixes = pvt.solve(observations, Navigation(ephemerides=wrong), EXACT)
    assert cause_of(fixes, signal.satellite) == Cause.RESIDUAL
    assert fixes.status[0] == Status.FIX
    assert errors(fixes)[0] < 1e-5


def test_a_wrong_fix_is_never_called_a_fix() -> None:
    """Up to three satellites false by anything, in every epoch others."""
    count, sigma = 600, 0.5
    observations = Sky("CG", satellites=6, epochs=count, interval_s=0.1, sigma_m=sigma).observe()
    random = np.random.default_rng(11)
    for epoch in range(count):
        false = random.choice(len(observations.signals), random.integers(0, 4), replace=False)
        size = 10 ** random.uniform(0.5, 6.0, false.size)
        observations.pseudorange_m[epoch, false] += size * random.choice([-1, 1], false.size)
    fixes = pvt.solve(observations, navigation(), exact(code_sigma_m=sigma))
    sound = fixes.status == Status.FIX
    assert 0.3 * count < sound.sum() < 0.9 * count
    # What the test cannot see is small: an error of 3 m has a satellite false by less than 10 m.
    assert errors(fixes)[sound].max() < 12.0
    assert np.median(errors(fixes)[fixes.status == Status.SUSPECT]) > 12.0


def test_a_bias_that_takes_the_last_measurement_leaves_nothing_to_check() -> None:
    """Five satellites, of one only the other signal: five unknowns."""
    observations = Sky("C", {"C": ("B1I", "B1CP")}, satellites=5).observe()
    observations.pseudorange_m[:, 1:9:2] = np.nan
    observations.pseudorange_m[:, 8] = np.nan
    fixes = pvt.solve(observations, navigation(), EXACT)
    assert fixes.used.sum() == 5
    assert fixes.status[0] == Status.UNCHECKED


def test_a_false_doppler_is_left_out_of_the_velocity() -> None:
    observations = Sky(satellites=7).observe()
    observations.doppler_hz[0, 2] += 500.0
    fixes = pvt.solve(observations, navigation(), EXACT)
    assert np.linalg.norm(fixes.velocity_m_s[0]) < 1e-3
    observations.doppler_hz[0, 4] -= 300.0
    doubtful = pvt.solve(observations, navigation(), EXACT)
    assert doubtful.status[0] == Status.FIX
    assert np.isnan(doubtful.velocity_m_s).all()


@pytest.mark.parametrize("worst", [np.nan, np.inf, -np.inf, 1e300, -1e300, 0.0, 1e9])
def test_numbers_that_are_none_do_no_harm(worst: float) -> None:
    observations = Sky(epochs=3).observe()
    observations.pseudorange_m[1, 2] = worst
    observations.doppler_hz[1, 3] = worst
    observations.cn0_dbhz[2, 4] = np.nan
    fixes = pvt.solve(observations, navigation(), EXACT)
    assert (fixes.status == Status.FIX).all()
    assert errors(fixes).max() < 1e-5
    assert fixes.cause[2, 4] == Cause.WEAK
