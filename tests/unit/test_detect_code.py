"""Tests of code delays: false alarms, drags with a steady carrier, and what must stay silent."""

import dataclasses

import numpy as np
import pytest
from scipy.constants import c as SPEED_OF_LIGHT
from simulated_tracks import Satellite, sideband, simulate_combo, simulate_log

from sdr_spoof.detectors import DetectionConfig, code_difference, code_minus_carrier, windows
from sdr_spoof.records import TrackLog
from sdr_spoof.verdict import detect

CHIP_RATES = {"B1I": 2.046e6, "B1CP": 1.023e6}
CODE_NOISE_M = {"B1I": 3.0, "B1CP": 1.0}
"""White noise of 10 ms epochs at 45 dB-Hz with the receiver's taps (0.5 and 0.12 chip apart)."""
LIMIT = 1e-6


def drag_m(time_s, start_s, speed_m_s):
    return speed_m_s * np.maximum(time_s - start_s, 0.0)


def combo_with(extra_m=0.0, *, duration_s=60.0, noise_m=3.2, seed=1, **satellite):
    """A pair whose code difference has the given course and realistic noise."""
    combo = simulate_combo(Satellite(**satellite), duration_s=duration_s, seed=seed)
    noise = noise_m * np.random.default_rng(seed).standard_normal(combo.epochs)
    course = extra_m(combo.time_s) if callable(extra_m) else extra_m
    difference = (25.0 + course + noise) / SPEED_OF_LIGHT
    return dataclasses.replace(combo, code_difference_s=difference)


def signal_with(extra_m=0.0, *, signal="B1I", duration_s=60.0, seed=1, **satellite):
    """One signal whose code has left its carrier by the given course, with realistic noise."""
    combo = simulate_combo(Satellite(**satellite), duration_s=duration_s, seed=seed)
    track = sideband(combo, signal)
    noise = CODE_NOISE_M[signal] * np.random.default_rng(seed).standard_normal(track.epochs)
    course = extra_m(track.time_s) if callable(extra_m) else extra_m
    chips = (course + noise) * CHIP_RATES[signal] / SPEED_OF_LIGHT
    return dataclasses.replace(track, code_phase_chips=track.code_phase_chips - chips)


def of_difference(config=None, **changes):
    return code_difference.statistic(combo_with(**changes), config or DetectionConfig())


def of_carrier(config=None, **changes):
    return code_minus_carrier.statistic(signal_with(**changes), config or DetectionConfig())


def first_alarm_s(series):
    beyond = np.abs(series.value) > series.threshold(LIMIT)
    return float(series.time_s[beyond][0]) if beyond.any() else None


BOTH = pytest.mark.parametrize("tested", [of_difference, of_carrier])


@BOTH
def test_false_alarms_come_no_more_often_than_stated(tested):
    # Two hours at 60 an hour; the bound leaves about half of them (alarm_rate).
    config = DetectionConfig(
        false_alarms_per_hour=60.0,
        code_wander_m=0.0,
        code_difference_drift_m_s=0.0,
        code_minus_carrier_drift_m_s=0.0,
    )
    series = tested(config, duration_s=7200.0)
    at = series.time_s[np.abs(series.value) > series.threshold(LIMIT)]
    alarms = int(at.size > 0) + np.count_nonzero(np.diff(at) > 20.0)
    assert 0.15 * 120.0 < alarms < 120.0 + 4 * np.sqrt(120.0)


@BOTH
@pytest.mark.parametrize("seed", range(1, 6))
def test_a_code_drag_with_a_steady_carrier_is_seen_within_fifteen_seconds(tested, seed):
    # 1.2 m/s, of which the loop sees two thirds while both peaks overlap (amplitudes 2 to 1).
    series = tested(extra_m=lambda t: drag_m(t, 40.0, -0.8), seed=seed)
    assert 40.0 < first_alarm_s(series) < 55.0


@BOTH
def test_a_jump_of_the_code_is_seen(tested):
    assert 40.0 < first_alarm_s(tested(extra_m=lambda t: 6.0 * (t > 40.0))) < 45.0


@BOTH
@pytest.mark.parametrize("period_s", [1.0, 7.0, 30.0, 120.0])
def test_weak_multipath_that_moves_is_no_alarm(tested, period_s):
    # Amplitude ratio 0.1 and 15 m of detour: up to 1.5 m either way on B1I.
    moving = {"extra_m": lambda t: 1.5 * np.sin(2 * np.pi * t / period_s), "duration_s": 240.0}
    assert first_alarm_s(tested(**moving)) is None
    if period_s > 1.0:
        assert first_alarm_s(tested(DetectionConfig(code_wander_m=0.0), **moving)) is not None


def test_the_band_is_named_and_the_onset_dated():
    clean = simulate_log(Satellite(), duration_s=60.0)
    dragged = {
        name: signal_with(lambda t, v=speed: drag_m(t, 40.0, v), signal=name)
        for name, speed in (("B1I", 1.2), ("B1CP", 0.0))
    }
    log = dataclasses.replace(clean, signals=tuple(dragged.values()))
    config = DetectionConfig(detectors=("code_minus_carrier",))
    alarmed = [
        s for s in code_minus_carrier.statistics(log, config) if first_alarm_s(s) is not None
    ]
    assert [s.signal for s in alarmed] == ["B1I"]
    (alarm,) = detect(log, config).satellites[0].alarms
    assert alarm.onset_s == pytest.approx(40.0, abs=1.0)


def test_the_signals_of_a_satellite_share_its_false_alarms():
    log = simulate_log(Satellite(), single=[(Satellite(7), "L1CA")], duration_s=20.0)
    config = DetectionConfig()
    upper, lower, alone = (s.threshold_sigmas for s in code_minus_carrier.statistics(log, config))
    assert upper == lower > alone


@BOTH
def test_motion_clock_and_slips_are_no_alarm(tested):
    moving = {"doppler_hz": 4000.0, "doppler_rate_hz_s": 1.0}
    slips = {30.0: ("B1I", 0.5), 44.0: ("B1CP", -1.0), 50.0: ("B1I", -1.5)}
    assert first_alarm_s(tested(duration_s=120.0, slips=slips, **moving)) is None


def test_ionosphere_and_drifting_biases_are_no_alarm():
    # 1.8 TECU a minute are 0.01 m/s of code minus carrier; a bias moves by 0.3 m a minute.
    assert first_alarm_s(of_carrier(extra_m=lambda t: 0.01 * t, duration_s=300.0)) is None
    assert first_alarm_s(of_difference(extra_m=lambda t: 0.005 * t, duration_s=300.0)) is None


@BOTH
def test_multipath_that_stays_is_no_alarm(tested):
    assert first_alarm_s(tested(extra_m=11.0)) is None


@BOTH
def test_a_gap_is_no_alarm_though_the_code_returns_elsewhere(tested):
    series = tested(extra_m=lambda t: 40.0 * (t > 30.5), lost=(30.0, 31.0), duration_s=90.0)
    assert first_alarm_s(series) is None
    assert set(series.segment) == {0, 1}
    # Settling, the least reference and the shortest window later it is tested again.
    again = series.time_s[series.segment == 1][0]
    assert 31.0 + 2.0 + 5.0 + 1.0 <= again + 1e-6 < 31.0 + 2.0 + 5.0 + 2.0 + 0.6


@BOTH
def test_short_or_weak_tracks_have_no_support(tested):
    short, weak = tested(duration_s=7.0), tested(cn0_dbhz=26.0)
    assert short.time_s.size == weak.time_s.size == 0
    assert "s are needed" in short.notes[-1]
    assert tested(lost=(0.0, 99.0)).time_s.size == 0


@pytest.mark.parametrize("module", [code_difference, code_minus_carrier])
def test_a_long_track_is_tested_in_sections_like_a_whole(monkeypatch, module):
    combo = combo_with(duration_s=200.0, lost=(75.03, 76.2))
    log = TrackLog("simulated", 120e6, 200.0, False, (sideband(combo, "B1I"),), (combo,))
    config = DetectionConfig()
    (whole,) = module.statistics(log, config)
    monkeypatch.setattr(windows, "SECTION_EPOCHS", 7011)
    parts = list(module.statistics(log, config))
    assert len(parts) == 3
    np.testing.assert_allclose(np.concatenate([p.time_s for p in parts]), whole.time_s, atol=1e-9)
    np.testing.assert_allclose(np.concatenate([p.value for p in parts]), whole.value, atol=1e-5)
