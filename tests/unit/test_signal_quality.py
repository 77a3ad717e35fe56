"""Delta and ratio metric: their laws, their false alarms, and what moves them."""

import dataclasses

import numpy as np
import pytest
from simulated_taps import quality_log, quality_track

from sdr_spoof import _core, detectors
from sdr_spoof.detectors import DetectionConfig, delta_metric, ratio_metric, windows
from sdr_spoof.detectors.alarm_rate import mean_alarms_per_hour
from sdr_spoof.detectors.signal_quality import noise_correlation, residual_variance
from sdr_spoof.records import State
from sdr_spoof.verdict import detect

CONFIG = DetectionConfig()
MEANS = ("delta_metric", "ratio_metric")
ALL = (*MEANS, "delta_metric_variance", "ratio_metric_variance")


def series_of(name, *tracks, config=CONFIG):
    return list(detectors.find(name).statistics(quality_log(*tracks), config))


def apart(series, config=CONFIG):
    """Tests whose windows share no epoch, in standard deviations of the thermal law."""
    step = round(config.quality_window_s / 0.01)
    return (series.value / series.sigma_thermal)[::step]


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize(
    ("signal", "modulation", "cn0_dbhz"),
    [("B1I", "Bpsk", 30.0), ("B1I", "Bpsk", 45.0), ("B1CP", "Qmboc", 32.0), ("B1CP", "Boc11", 40)],
)
def test_the_law_holds_with_correlated_taps(name, signal, modulation, cn0_dbhz):
    config = DetectionConfig(quality_window_s=0.3, quality_reference_s=6.0)
    track = quality_track(
        signal=signal, modulation=modulation, cn0_dbhz=cn0_dbhz, duration_s=300.0, seed=5
    )
    (series,) = series_of(name, track, config=config)
    z = apart(series, config)
    assert z.size > 950
    # 4 standard errors of a mean and of a mean square.
    assert abs(np.mean(z)) < 4 / np.sqrt(z.size)
    assert abs(np.mean(z**2) - 1) < 4 * np.sqrt(2 / z.size)


@pytest.mark.parametrize("name", ALL)
def test_the_rate_of_false_alarms_is_the_stated_one(name):
    # 400 alarms an hour of each of two runs of 400 s; clumps are a window apart.
    config = DetectionConfig(
        quality_window_s=0.3, quality_reference_s=6.0, false_alarms_per_hour=400.0
    )
    found, expected = 0, 2 * 400.0 * (400.0 - 8.3) / 3600.0
    for seed in (1, 2):
        (series,) = series_of(name, quality_track(duration_s=400.0, seed=seed), config=config)
        at = series.time_s[np.abs(series.value) > series.threshold(1e-6)]
        found += 1 + np.count_nonzero(np.diff(at) > 0.3)
    # A mean is widened by what its reference scatters by chance, never narrowed.
    assert 0.4 * expected < found < expected + 4 * np.sqrt(expected)


def test_the_law_is_the_textbook_one_for_delta():
    track = quality_track(cn0_dbhz=50.0, duration_s=15.0)
    (series,) = series_of("delta_metric", track)
    separation = _core.early_late("Bpsk", 0.25)[0]
    textbook = (1.0 - separation) / (4.0 * 1e5 * 0.01)
    of_window = 1 / 100 + 1 / 1000  # epochs in the window and in the reference
    assert series.sigma_thermal[-1] ** 2 == pytest.approx(textbook * of_window, rel=0.03)


def test_the_ratio_shares_its_noise_with_the_prompt():
    track = quality_track(duration_s=1.0)
    own, shared = noise_correlation(track, ratio_metric.METRIC)
    near, wide = _core.early_late("Bpsk", 0.125)[0], _core.early_late("Bpsk", 0.25)[0]
    assert shared == pytest.approx(near)
    assert residual_variance((own, shared), near) == pytest.approx((1 + wide) / 2 - near**2)


@pytest.mark.parametrize("name", ALL)
def test_what_is_there_all_along_is_no_alarm(name):
    # Static multipath, a change of gain, and a slow fade to 35 dB-Hz.
    time = np.arange(4000) * 0.01
    track = quality_track(
        duration_s=40.0,
        cn0_dbhz=45.0 - 0.25 * time,
        gain_db=np.where(time > 20, 6.0, 0.0),
        rays=[(0.7, 0.3, 0.2)],
    )
    (series,) = series_of(name, track)
    assert np.all(np.abs(series.value) < series.threshold(1e-6))


@pytest.mark.parametrize("signal", ["B1I", "B1CP"])
@pytest.mark.parametrize("name", MEANS)
def test_a_second_peak_is_seen_and_names_its_signal(name, signal):
    time = np.arange(3000) * 0.01
    ray = (np.where(time > 20.0, 0.8, 0.0), 0.35 if signal == "B1I" else 0.15, 0.0)
    modulation = "Bpsk" if signal == "B1I" else "Qmboc"
    track = quality_track(signal=signal, modulation=modulation, rays=[ray], duration_s=30.0)
    config = CONFIG.model_copy(update={"detectors": (name,)})
    (satellite,) = detect(quality_log(track), config).satellites
    (alarm,) = satellite.alarms
    assert (satellite.verdict, alarm.band) == ("suspect", signal)
    assert alarm.onset_s == pytest.approx(20.0, abs=0.05)
    assert 20.0 < alarm.alarm_s < 21.0


@pytest.mark.parametrize("name", ["delta_metric_variance", "ratio_metric_variance"])
def test_a_beat_is_seen_by_its_scatter(name):
    # A turning ray: the mean over a second stays, the epochs scatter.
    time = np.arange(3000) * 0.01
    ray = (np.where(time > 20.0, 0.3, 0.0), 0.3, 6.0 * time)
    (series,) = series_of(name, quality_track(rays=[ray], duration_s=30.0))
    hit = series.value > series.threshold(1e-6)
    assert not hit[series.time_s < 20.0].any()
    assert hit[(series.time_s > 20.8) & (series.time_s < 21.2)].all()


def test_joint_tracking_is_another_piece_for_delta_alone():
    track = quality_track(duration_s=20.0)
    state = np.where(track.time_s < 8.0, State.SYNCED, State.COMBO).astype(np.uint8)
    track = dataclasses.replace(track, state=state)
    (delta,), (ratio,) = series_of("delta_metric", track), series_of("ratio_metric", track)
    assert np.unique(delta.segment).size == 2
    assert np.unique(ratio.segment).size == 1
    assert not np.any((delta.time_s > 8.0) & (delta.time_s < 8.0 + 2.0 + 2.0))


@pytest.mark.parametrize("name", ALL)
def test_sections_give_the_tests_of_the_whole(name, monkeypatch):
    track = quality_track(duration_s=60.0)
    (whole,) = series_of(name, track)
    monkeypatch.setattr(windows, "SECTION_EPOCHS", 2500)
    parts = series_of(name, track)
    assert len(parts) == 3
    np.testing.assert_array_equal(np.concatenate([p.time_s for p in parts]), whole.time_s)
    value = np.concatenate([p.value for p in parts])
    np.testing.assert_allclose(value, whole.value, atol=1e-6)


def test_shares_add_up_to_one():
    both = quality_track(), quality_track(signal="B1CP", modulation="Boc11")
    for name in (*ALL, "power"):
        series = series_of(name, *both)
        # The noise floor of a band, a quarter of what power may do, takes two satellites.
        assert sum(s.share for s in series) == pytest.approx(0.75 if name == "power" else 1.0)
        assert {s.signal for s in series} == {"B1I", "B1CP"}
    (alone,) = series_of("delta_metric", both[0])
    half = series_of("delta_metric", *both)[0]
    rates = [mean_alarms_per_hour(s.threshold_sigmas, 100, 1000, 0.01) for s in (alone, half)]
    assert rates == pytest.approx([1e-3, 0.5e-3], rel=1e-6)


def test_weak_or_unsynchronised_signals_are_not_tested():
    weak = quality_track(cn0_dbhz=24.0)
    early = dataclasses.replace(quality_track(), state=np.full(6000, State.TRACKING, np.uint8))
    none = quality_track(duration_s=0.0)
    for track in (weak, early, none):
        for name in ALL:
            assert sum(s.time_s.size for s in series_of(name, track)) == 0


def test_names_are_registered():
    assert {delta_metric.NAME, delta_metric.SCATTER} <= set(detectors.DETECTORS)
    assert detectors.find("ratio_metric").evidence == "quality"
