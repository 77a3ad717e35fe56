"""The Kalman filter of positioning."""

from __future__ import annotations

import dataclasses

import numpy as np
from observed_sky import PLACE, Sky, navigation

from sdr_spoof import pvt
from sdr_spoof.fixes import Cause, Fixes, Status
from sdr_spoof.pvt import PvtConfig

SIGMA, RATE_SIGMA = 1.0, 0.1
CONFIG = PvtConfig(
    filter="ekf",
    ionosphere="none",
    troposphere="none",
    zenith_sigma_m=0.0,
    weights="equal",
    code_sigma_m=SIGMA,
    doppler_sigma_m_s=RATE_SIGMA,
    acceleration_m_s2=0.5,
    clock_m_s=0.2,
    clock_drift_m_s2=0.1,
)


def walk(random: np.random.Generator, steps: int, dt: float, density: float, axes: int):
    """A random walk and its integral, (steps, axes) each: white noise of some density, exact."""
    covariance = density**2 * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
    noise = random.standard_normal((steps, axes, 2)) @ np.linalg.cholesky(covariance).T
    rate = np.vstack([np.zeros((1, axes)), np.cumsum(noise[1:, :, 1], axis=0)])
    place = np.zeros((steps, axes))
    for k in range(1, steps):
        place[k] = place[k - 1] + rate[k - 1] * dt + noise[k, :, 0]
    return place, rate


def moving_sky(seed: int, epochs: int, dt: float = 0.5) -> tuple[Sky, np.ndarray]:
    random = np.random.default_rng(seed)
    place, velocity = walk(random, epochs, dt, CONFIG.acceleration_m_s2, 3)
    clock, drift = walk(random, epochs, dt, CONFIG.clock_drift_m_s2, 1)
    white = CONFIG.clock_m_s * np.sqrt(dt) * np.cumsum(random.standard_normal(epochs))
    start_velocity = np.array([10.0, -5.0, 3.0])
    times = np.arange(epochs) * dt
    track = PLACE + place + times[:, None] * start_velocity
    sky = Sky(
        epochs=epochs,
        interval_s=dt,
        satellites=7,
        track=track,
        track_velocity=velocity + start_velocity,
        clock_m=500.0 + clock[:, 0] + white + 30.0 * times,
        drift_m_s=drift[:, 0] + 30.0,
        sigma_m=SIGMA,
        rate_sigma_m_s=RATE_SIGMA,
        seed=seed + 1000,
    )
    return sky, track


def squares(fixes: Fixes, error: np.ndarray) -> np.ndarray:
    return np.einsum("ei,eij,ej->e", error, np.linalg.inv(fixes.covariance_m2), error)


def test_errors_are_as_the_filter_says() -> None:
    """NEES of the position: mean 3 where process and noise are those configured."""
    runs, sharper = [], []
    for seed in range(14):
        sky, track = moving_sky(seed, 40)
        observations = sky.observe()
        fixes = pvt.solve(observations, navigation(), CONFIG)
        single = pvt.solve(
            observations, navigation(), CONFIG.model_copy(update={"filter": "least-squares"})
        )
        assert (fixes.status == Status.FIX).all()
        runs.append(squares(fixes, fixes.position_m - track)[10:].mean())
        sharper.append(np.std(fixes.position_m - track) / np.std(single.position_m - track))
    assert abs(np.mean(runs) - 3.0) < 4 * np.std(runs) / np.sqrt(len(runs))
    assert np.mean(sharper) < 0.7


def test_a_false_satellite_is_left_out_and_named() -> None:
    sky, track = moving_sky(3, 40)
    observations = sky.observe()
    ranges = observations.pseudorange_m.copy()
    ranges[20:, 2] += 50.0
    biased = dataclasses.replace(observations, pseudorange_m=ranges)
    fixes = pvt.solve(biased, navigation(), CONFIG)
    assert (fixes.cause[20:, 2] == Cause.RESIDUAL).all()
    assert (fixes.status == Status.FIX).all()
    assert squares(fixes, fixes.position_m - track)[20:].mean() < 10.0


def test_it_coasts_through_a_gap_and_says_so() -> None:
    sky, track = moving_sky(4, 60)
    observations = sky.observe()
    observations.pseudorange_m[30:34, 3:] = np.nan
    observations.pseudorange_m[40:56] = np.nan
    fixes = pvt.solve(observations, navigation(), CONFIG)
    assert (fixes.status[30:34] == Status.UNCHECKED).all()
    assert (fixes.status[34:40] == Status.FIX).all()
    assert np.linalg.norm(fixes.position_m - track, axis=1)[30:34].max() < 10.0
    # Five seconds (ten epochs) without any satellite, and it gives up.
    assert (fixes.status[40:49] == Status.UNCHECKED).all()
    assert (fixes.status[51:56] == Status.NO_FIX).all()
    assert (fixes.status[56:] == Status.FIX).all()
    spread = np.trace(fixes.covariance_m2, axis1=1, axis2=2)
    assert np.all(np.diff(spread[40:49]) > 0)


def test_a_jump_of_all_satellites_is_suspect_before_it_is_followed() -> None:
    """A place 500 m off from one epoch to the next, consistent in itself."""
    sky, _ = moving_sky(5, 30)
    assert sky.track is not None
    jumped = dataclasses.replace(
        sky, track=sky.track + np.where(np.arange(30) > 9, 500.0, 0.0)[:, None]
    )
    fixes = pvt.solve(jumped.observe(), navigation(), CONFIG)
    assert (fixes.status[:10] == Status.FIX).all()
    assert (fixes.status[10:20] == Status.SUSPECT).all()
    assert (fixes.status[21:] == Status.FIX).all()


def test_offset_between_systems_is_carried_on() -> None:
    sky = Sky("CG", epochs=40, satellites=5, sigma_m=SIGMA, offsets_m={"G": 60.0})
    fixes = pvt.solve(sky.observe(), navigation(), CONFIG)
    offset = fixes.clock_m[:, 1] - fixes.clock_m[:, 0]
    assert abs(offset[-1] - 60.0) < 1.5
    assert np.std(offset[20:]) < 0.5
    assert np.isfinite(fixes.dop).all()
