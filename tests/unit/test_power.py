"""Power: what rises, what only falls or comes back, and what interference does."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import lfilter
from simulated_taps import SAMPLE_RATE_HZ, quality_log, quality_track

from sdr_spoof import detectors
from sdr_spoof.detectors import DetectionConfig, power, windows
from sdr_spoof.verdict import detect

CONFIG = DetectionConfig()
TIME = (np.arange(6000) + 0.5) * 0.01
POWER = DetectionConfig(detectors=("power",))


def series_of(track, config=CONFIG):
    found = detectors.find("power").statistics(quality_log(track), config)
    return {s.quantity: s for s in found}


def alarmed(track, config=POWER):
    """Quantities that alarmed."""
    (satellite,) = detect(quality_log(track), config).satellites
    return {a.quantity for a in satellite.alarms}


def running_noise(slices, seed):
    """Noise power as the tracker averages it: over 2 s of 1 ms slices."""
    white = np.random.default_rng(seed).exponential(size=slices + 20000)
    return lfilter([1 / 2000], [1, -1 + 1 / 2000], white)[20000:]


def noisier(track, noise_db):
    """The track with noise added that lowers C/N0 alike: prompts keep their power."""
    assert np.all(noise_db >= 0)
    rng = np.random.default_rng(9)
    factor = 10 ** (noise_db / 10)
    extra = np.sqrt(factor - 1.0)[:, None]
    white = rng.standard_normal((2, *track.taps.shape))
    return dataclasses.replace(
        track,
        taps=(track.taps + extra * (white[0] + 1j * white[1])).astype(np.complex64),
        noise_power=track.noise_power * factor,
        cn0_dbhz=track.cn0_dbhz - noise_db,
    )


@pytest.mark.parametrize("cn0_dbhz", [30.0, 38.0, 48.0])
def test_the_variance_of_a_window_is_that_of_the_law(cn0_dbhz):
    config = DetectionConfig(power_window_s=0.2, settle_s=0.0)
    track = quality_track(cn0_dbhz=cn0_dbhz, duration_s=250.0)
    rows, _ = power._rows(track, SAMPLE_RATE_HZ, config)
    level, variance = power._level(rows, 20, 0.01, power.AGAINST)
    apart = level[::20]
    spread = 4 * np.sqrt(2.0 / apart.size)
    assert np.var(apart) / np.mean(variance) == pytest.approx(1.0, abs=spread)


@pytest.mark.parametrize("window_s", [0.2, 1.0, 5.0])
def test_the_variance_of_the_trackers_noise_power(window_s):
    noise = running_noise(2_000_000, seed=3).reshape(-1, round(window_s * 1000)).mean(axis=1)
    apart = noise[:: max(round(10.0 / window_s), 1)]
    expected = power.noise_variance(window_s)
    assert np.var(apart) / expected == pytest.approx(1.0, abs=4 * np.sqrt(2.0 / apart.size))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_false_alarms_are_no_more_than_stated(seed):
    # Without the allowance for innocent wander, against the largest reference: conservative.
    config = DetectionConfig(
        power_wander_db=0.0,
        power_reference_s=2.0,
        power_window_s=0.5,
        false_alarms_per_hour=600.0,
    )
    for series in series_of(quality_track(duration_s=300.0, seed=seed), config).values():
        at = series.time_s[series.value > series.threshold(1e-6)]
        found = np.count_nonzero(np.diff(at) > 0.5) + (at.size > 0)
        expected = 50.0 * series.share
        assert found <= expected + 4 * np.sqrt(expected)


def test_a_fade_and_the_return_from_it_are_no_alarm():
    fade = np.where((TIME > 20) & (TIME < 28), -9.0, 0.0)
    assert alarmed(quality_track(cn0_dbhz=45.0 + fade)) == set()


@pytest.mark.parametrize("rise_db", [3.5, 8.0])
def test_a_stronger_signal_raises_prompt_and_cn0(rise_db):
    found = alarmed(quality_track(cn0_dbhz=45.0 + np.where(TIME > 30, rise_db, 0.0)))
    assert found == {power.CN0, power.AGAINST}


def test_interference_raises_the_noise_alone():
    jammed = noisier(quality_track(cn0_dbhz=45.0), np.where(TIME > 30, 6.0, 0.0))
    assert alarmed(jammed) == {power.NOISE}


def test_a_spoofer_that_hides_its_cn0_under_noise_is_seen_against_power():
    # Prompt and noise rise alike: C/N0 says nothing, C/N0 against power does.
    rise = np.where(TIME > 30, 5.0, 0.0)
    hidden = noisier(quality_track(cn0_dbhz=45.0 + rise), rise)
    assert alarmed(hidden) == {power.NOISE, power.AGAINST}


def test_a_calibrated_floor_shows_noise_that_was_always_there():
    track = quality_track(cn0_dbhz=45.0, duration_s=20.0)
    floor = float(track.noise_power[0])
    assert alarmed(track, POWER.model_copy(update={"power_noise_floor": floor})) == set()
    half = POWER.model_copy(update={"power_noise_floor": floor / 4})
    assert alarmed(track, half) == {power.NOISE}


def test_the_onset_and_the_signal_are_named():
    track = quality_track(signal="B1CP", modulation="Boc11", cn0_dbhz=45 + 6.0 * (TIME > 30))
    (satellite,) = detect(quality_log(track), POWER).satellites
    assert satellite.verdict == "suspect"
    for alarm in satellite.alarms:
        assert alarm.band == "B1CP"
        assert alarm.onset_s == pytest.approx(30.0, abs=0.05)
        assert 30.0 < alarm.alarm_s < 31.0


def test_the_past_counts_across_a_loss_of_lock():
    track = quality_track(cn0_dbhz=45 + 6.0 * (TIME > 30))
    lost = np.where((TIME > 28) & (TIME < 32), 0, track.state).astype(np.uint8)
    assert power.AGAINST in alarmed(dataclasses.replace(track, state=lost))


def test_sections_give_the_tests_of_the_whole(monkeypatch):
    track = quality_track(duration_s=60.0)
    whole = series_of(track)
    monkeypatch.setattr(windows, "SECTION_EPOCHS", 3000)
    parts = list(detectors.find("power").statistics(quality_log(track), CONFIG))
    for quantity, one in whole.items():
        value = np.concatenate([p.value for p in parts if p.quantity == quantity])
        # A section looks back over the reference, not to the beginning of the track.
        np.testing.assert_allclose(value, one.value, atol=1e-9)


def test_a_silent_or_empty_track_gives_no_tests():
    for track in (quality_track(duration_s=0.0), quality_track(duration_s=1.0)):
        assert sum(s.time_s.size for s in series_of(track).values()) == 0
