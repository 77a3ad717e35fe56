"""The phase-difference rate: its law under H0, and what must not disturb it."""

import dataclasses

import numpy as np
import pytest
from simulated_tracks import Attack, Satellite, simulate_combo, simulate_log

from sdr_spoof import detectors
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.detectors.combo_model import threshold_for_pfa_hz
from sdr_spoof.detectors.phase_difference_rate import statistic
from sdr_spoof.detectors.slips import find_slips
from sdr_spoof.detectors.windows import segments, sliding_slope, slope_sigma
from sdr_spoof.errors import ConfigError
from sdr_spoof.verdict import detect

THERMAL = DetectionConfig(threshold_model="thermal", settle_s=0.0, min_cn0_dbhz=20.0)


@pytest.mark.parametrize("cn0_dbhz", [30.0, 45.0])
def test_thermal_law_and_false_alarm_rate(cn0_dbhz):
    # 3000 independent windows; variance and Pfa = 1e-2 within 4 standard errors.
    combo = simulate_combo(Satellite(cn0_dbhz=cn0_dbhz), duration_s=3000.0)
    series = statistic(combo, THERMAL)
    rows = slice(None, None, 100)
    normalised = series.value[rows] / series.sigma[rows]
    count = normalised.size
    assert count == 3000
    # The simulation draws the small-noise law; the squaring term adds 2.5 % variance at 30 dB-Hz.
    squaring = 1 + 1 / (2 * 10 ** (cn0_dbhz / 10) * 0.01)
    assert np.mean(normalised**2) * squaring == pytest.approx(1.0, abs=4 * np.sqrt(2 / count))
    pfa = 0.01
    crossed = np.mean(
        np.abs(normalised) * np.sqrt(squaring) > threshold_for_pfa_hz(1, pfa, two_sided=True)
    )
    assert crossed == pytest.approx(pfa, abs=4 * np.sqrt(pfa * (1 - pfa) / count))


def test_reachable_thresholds():
    # One-second slopes of 10 ms epochs: slope noise 10.8 and 3.2 mHz at 35 and 45 dB-Hz, simulated
    # independently at correlator level with 10 Hz loops, whose filtering adds up to a tenth.
    for cn0_dbhz, sigma_hz in ((35.0, 10.8e-3), (45.0, 3.2e-3)):
        series = statistic(simulate_combo(Satellite(cn0_dbhz=cn0_dbhz), duration_s=5.0), THERMAL)
        assert float(np.median(series.sigma)) == pytest.approx(sigma_hz, rel=0.10)


def test_doppler_does_not_leak():
    # 800 m/s: the raw difference would move by 38 Hz, the scaled one must not move at all.
    noiseless = Satellite(doppler_hz=4163.0, doppler_rate_hz_s=1.0, cn0_dbhz=120.0)
    combo = simulate_combo(noiseless)
    raw = np.diff(combo.phase_upper_cycles - combo.phase_lower_cycles) / 0.01
    assert abs(raw.mean()) > 38.0
    series = statistic(combo, DetectionConfig())
    assert np.max(np.abs(series.value)) < 1e-5


def test_detection_probability_at_a_weak_drag():
    # A drag of exactly the threshold is seen half of the time; 400 independent windows, 4 s.e.
    combo = simulate_combo(Satellite(cn0_dbhz=40.0), duration_s=400.0)
    quiet = statistic(combo, THERMAL)
    limit = float(np.median(quiet.threshold(1e-3)))
    drifting = dataclasses.replace(
        combo, phase_upper_cycles=combo.phase_upper_cycles + limit * combo.time_s
    )
    series = statistic(drifting, THERMAL)
    seen = np.mean((np.abs(series.value) > series.threshold(1e-3))[::100])
    assert seen == pytest.approx(0.5, abs=4 * np.sqrt(0.25 / 399))


def test_published_law_is_the_default_and_wider():
    combo = simulate_combo(Satellite(cn0_dbhz=30.0), duration_s=5.0)
    series = statistic(combo, DetectionConfig())
    # 30 dB-Hz in both bands: sqrt(2) x 0.10116 Hz, the scaling adds half a percent.
    assert float(series.sigma[0]) == pytest.approx(np.sqrt(2) * 0.10116, rel=0.01)
    assert np.all(series.sigma > 3 * series.sigma_thermal)


def test_slope_equals_polyfit():
    rng = np.random.default_rng(5)
    values = rng.standard_normal(60).cumsum() + 1e5
    slopes = sliding_slope(values, 25, 0.02)
    expected = [np.polyfit(np.arange(25) * 0.02, values[k : k + 25], 1)[0] for k in range(36)]
    np.testing.assert_allclose(slopes, expected, rtol=1e-6, atol=1e-8)
    assert float(slope_sigma(np.array(1.0), 25, 0.02)) == pytest.approx(
        1 / np.sqrt(np.sum((np.arange(25) * 0.02 - 0.24) ** 2))
    )


def test_pieces_end_at_lost_rows_and_gaps():
    time = np.concatenate([np.arange(100), np.arange(150, 250)]) * 0.01
    usable = np.ones(200, dtype=bool)
    usable[40:50] = False
    assert segments(time, usable) == [slice(0, 40), slice(50, 100), slice(100, 200)]


def test_no_window_spans_a_loss_of_lock():
    series = statistic(simulate_combo(Satellite(lost=(8.0, 8.5))), DetectionConfig())
    assert not np.any((series.time_s > 8.01) & (series.time_s < 8.5 + 0.5 + 1.0 - 0.02))
    assert np.max(np.abs(series.value)) < 0.05
    assert set(series.segment) == {0, 1}


@pytest.mark.parametrize(
    ("band", "cycles"), [("B1I", 0.5), ("B1I", -1.0), ("B1CP", 1.0), ("B1CP", -2.0)]
)
@pytest.mark.parametrize("cn0_dbhz", [33.0, 45.0])
def test_a_single_slip_is_repaired(band, cycles, cn0_dbhz):
    log = simulate_log(Satellite(cn0_dbhz=cn0_dbhz, slips={9.0: (band, cycles)}))
    (satellite,) = detect(log, DetectionConfig()).satellites
    assert satellite.verdict == "clean"
    assert "1 cycle slip(s) repaired" in satellite.reason


def test_a_half_cycle_jump_of_the_pilot_is_no_slip():
    # The pilot's sign is known: its loop cannot slip by half a cycle, a spoofer can.
    verdict = detect(simulate_log(Satellite(slips={9.0: ("B1CP", 0.5)})))
    assert verdict.spoofed
    assert verdict.satellites[0].alarms[0].onset_s == pytest.approx(9.0, abs=0.02)


def test_jumps_in_a_burst_are_left_in():
    # Half-cycle jumps of one sign, three in a second: a beat, not thermal slips.
    slips = {9.0 + 0.3 * k: ("B1I", 0.5) for k in range(3)}
    assert detect(simulate_log(Satellite(slips=slips))).spoofed


def test_a_jump_that_is_no_multiple_is_seen():
    verdict = detect(simulate_log(Satellite(slips={9.0: ("B1I", 0.3)})))
    assert verdict.spoofed
    assert verdict.satellites[0].alarms[0].band == "B1I"


def test_noise_makes_no_slips():
    rng = np.random.default_rng(8)
    assert find_slips(0.045 * rng.standard_normal(20_000), 0.5, 0.045) == []


def test_low_cn0_is_not_tested():
    log = dataclasses.replace(simulate_log(Satellite(cn0_dbhz=25.0)), signals=())
    (satellite,) = detect(log).satellites
    assert satellite.verdict == "not enough support"
    assert "28 dB-Hz" in satellite.reason


def test_unknown_detector_is_named():
    with pytest.raises(ConfigError, match="known detectors: phase_difference_rate"):
        detectors.find("phase")


def test_attack_model_of_the_simulation_starts_at_zero():
    shift, amplitude = Attack(start_s=1.0).apply(np.array([0.0, 0.99]))
    np.testing.assert_allclose((shift, amplitude), ([0, 0], [1, 1]))
