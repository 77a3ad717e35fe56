"""The smoother of the tightly coupled filter: better, consistent, and right across breaks."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from tight_voyage import CONFIG, distance, made, measured, start

from sdr_spoof.aiding.imu.errors import read
from sdr_spoof.aiding.imu.grades import draw
from sdr_spoof.aiding.simulated import ReceiverNoise, range_pull, velocity_drag
from sdr_spoof.aiding.tight import run

SMOOTH = CONFIG.model_copy(update={"smooth": True})


@pytest.fixture(scope="module")
def voyage():
    """With the errors of a real IMU."""
    ideal, truth = made()
    return read(ideal, draw("ship-a", 5)[0]).log, truth


def flown(voyage, *attacks, **settings):
    """With codes without coloured errors if the filter has no states for them."""
    config = SMOOTH.model_copy(update=settings)
    noise = ReceiverNoise(code_markov_m=config.code_wander_m)
    return run(voyage[0], measured(voyage, *attacks, noise=noise), start(voyage), config)


def off(found, voyage):
    """Of the smoothed places."""
    return distance(replace(found, position_m=found.smoothed.position_m), voyage)


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("more", [{}, {"carrier_noise_m": 0.002}, {"states": 11}])
def test_covariances_are_symmetric_positive_and_smaller(voyage, more):
    found = flown(voyage, exclusion="off", **more)
    own, later = found.covariance, found.smoothed.covariance
    assert np.array_equal(later, np.swapaxes(later, -1, -2))
    assert np.linalg.eigvalsh(later).min() > 0
    gained = np.linalg.eigvalsh(own - later) / np.linalg.eigvalsh(own)[..., -1:]
    assert gained.min() > -1e-9
    # Nothing comes after the last epoch.
    np.testing.assert_allclose(later[-1], own[-1], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.smoothed.position_m[-1], found.position_m[-1], atol=1e-6)


def test_the_filter_is_the_same_with_and_without(voyage):
    found = flown(voyage)
    without = flown(voyage, smooth=False)
    assert without.smoothed is None
    for field in fields(found):
        if field.name not in {"smoothed", "satellites", "reference"}:
            ours, theirs = (getattr(s, field.name) for s in (found, without))
            np.testing.assert_array_equal(ours, theirs, field.name)


def test_an_outage_is_bridged_from_both_sides(voyage):
    worse = (read(made()[0], draw("ship-b", 5)[0]).log, voyage[1])
    found = flown(
        worse,
        exclusion="off",
        outages_s=((90.0, 170.0),),
        code_wander_m=0.0,
        gyro_bias_deg_h=1.0,
        accelerometer_bias_ug=300.0,
    )
    late = slice(150, 170)
    assert rms(distance(found, voyage)[late]) > 5 * rms(off(found, voyage)[late])
    sigma = np.sqrt(np.trace(found.smoothed.covariance[:, 0, :2, :2], axis1=1, axis2=2))
    assert np.all(off(found, voyage) < 4 * sigma)
    # Most uncertain in the middle, between what is known on both sides.
    assert 110 < 90 + np.argmax(sigma[90:170]) < 150


def test_the_way_back_at_a_copy_is_that_without_gnss_since_then(voyage):
    attack = velocity_drag((0.6, 0.8, 0.0), 140.0, 155.0)
    # Without states behind those of navigation nothing is forgotten but what came since then.
    found = flown(voyage, attack, code_wander_m=0.0, dwell_after_step_s=10.0)
    alarm, *_, readmitted = found.events
    assert alarm.time_s < 144.0 and alarm.back_s > 60.0
    assert readmitted.state == "trusted"
    gap = (alarm.time_s - alarm.back_s + 0.5, readmitted.time_s + 0.5)
    cut = flown(voyage, attack, code_wander_m=0.0, exclusion="off", outages_s=(gap,))
    apart = np.linalg.norm(found.smoothed.position_m - cut.smoothed.position_m, axis=1)
    assert apart.max() < 1e-3
    mine, theirs = found.smoothed.covariance, cut.smoothed.covariance
    sizes = np.sqrt(np.diagonal(theirs, axis1=2, axis2=3))
    assert (np.abs(mine - theirs) < 5e-3 * sizes[..., None] * sizes[..., None, :]).all()
    # The false measurements that the filter had used before it alarmed do not count.
    inside = slice(int(gap[0]), int(gap[1]))
    assert off(found, voyage)[inside].max() < 0.7 < distance(found, voyage)[inside].max()


def test_satellites_left_out_by_name_do_not_move_it(voyage):
    three = ("C02", "C05", "C08")
    attack = range_pull((0.0, 1.0, 0.0), 100.0, 160.0, satellites=three)
    found = flown(voyage, attack)
    assert any(e.state == "partial" for e in found.events)
    assert off(found, voyage).max() < 4.0
    assert rms(off(found, voyage)) < rms(distance(found, voyage))


def test_what_is_not_valid_is_nan(voyage):
    log = voyage[0]
    kept = slice(0, 10000)
    part = replace(
        log,
        time_s=log.time_s[kept],
        rotation_rad=log.rotation_rad[kept],
        velocity_m_s=log.velocity_m_s[kept],
    )
    found = run(part, measured(voyage), start(voyage), SMOOTH)
    known = np.isfinite(found.smoothed.position_m).all(axis=1)
    np.testing.assert_array_equal(known, found.valid)
    assert known.sum() == 101


def test_gaps_of_both_sensors(voyage):
    log, data = voyage[0], measured(voyage)
    ranges, velocity = data.range_m.copy(), log.velocity_m_s.copy()
    ranges[80:110, 2:] = np.nan
    velocity[15000:15020] = np.nan
    broken = replace(log, velocity_m_s=velocity)
    config = SMOOTH.model_copy(update={"exclusion": "off"})
    found = run(broken, replace(data, range_m=ranges), start(voyage), config)
    assert np.linalg.eigvalsh(found.smoothed.covariance).min() > 0
    assert off(found, voyage).max() < 4.0
