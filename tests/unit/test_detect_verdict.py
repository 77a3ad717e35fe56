"""Rule, onset, band and the words of the verdict."""

import numpy as np
import pytest
from simulated_tracks import Attack, Satellite, simulate_combo, simulate_log

from sdr_spoof import decision
from sdr_spoof.decision.onset import change_point
from sdr_spoof.detectors import DetectionConfig, windows
from sdr_spoof.detectors.phase_difference_rate import statistic
from sdr_spoof.errors import ConfigError
from sdr_spoof.records import State
from sdr_spoof.verdict import detect as fused
from sdr_spoof.verdict import statistics

RATE = DetectionConfig(detectors=("phase_difference_rate",))


def detect(log, config=RATE):
    """The verdict of one detector alone; all of them are in test_fusion.py."""
    return fused(log, config)


def only_alarm(verdict):
    (alarm,) = [a for s in verdict.satellites for a in s.alarms]
    return alarm


def test_clean_satellites_raise_no_alarm():
    satellites = [
        Satellite(prn, cn0_dbhz=cn0, doppler_hz=doppler)
        for prn, cn0, doppler in ((19, 45, 3000), (23, 40, -3000), (34, 35, 500), (36, 30, -1200))
    ]
    for model in ("published", "thermal"):
        verdict = detect(
            simulate_log(*satellites), RATE.model_copy(update={"threshold_model": model})
        )
        assert not verdict.spoofed
        assert [s.verdict for s in verdict.satellites] == ["clean"] * 4
        assert "coherent" in verdict.limits


@pytest.mark.parametrize("band", ["B1I", "B1CP"])
@pytest.mark.parametrize("drag_hz", [0.3, 2.0, -10.0])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_onset_and_band_of_an_aligned_drag(band, drag_hz, seed):
    attacked = Satellite(23, attack=Attack(band=band, start_s=12.0, drag_hz=drag_hz))
    verdict = detect(simulate_log(attacked, Satellite(24), seed=seed))
    alarm = only_alarm(verdict)
    assert (alarm.prn, alarm.band) == (23, band)
    # Measured over 200 runs each: within 20 ms from 2 Hz on, 30 ms at 1 Hz, 100 ms at 0.3 Hz.
    assert alarm.onset_s == pytest.approx(12.0, abs=0.02 + 0.025 / abs(drag_hz))
    assert alarm.onset_s <= alarm.alarm_s < 13.0
    assert abs(alarm.statistic) > alarm.threshold
    assert alarm.log10_p < -6


def test_a_capture_with_random_phase_is_seen_by_its_jump():
    # No drag at all: only the phase jumps, by the angle of 1 + 1.5 exp(j 2 pi 0.3).
    attack = Attack(start_s=12.0, drag_hz=0.0, phase_cycles=0.3)
    alarm = only_alarm(detect(simulate_log(Satellite(attack=attack))))
    assert alarm.onset_s == pytest.approx(12.0, abs=0.02)
    assert alarm.band == "B1CP"


def test_common_motion_is_not_blamed_on_a_band():
    # Both bands leave together, as for a jerk of the receiver, plus an attack on one: no band.
    combo = simulate_combo(Satellite(attack=Attack(start_s=12.0, drag_hz=0.5)))
    jerk = 400.0 * np.maximum(combo.time_s - 12.0, 0.0) ** 3
    shaken = {
        "phase_lower_cycles": combo.phase_lower_cycles + jerk,
        "phase_upper_cycles": combo.phase_upper_cycles + jerk * 1575.42 / 1561.098,
    }
    verdict = detect(with_combo(combo, **shaken))
    assert only_alarm(verdict).band is None
    assert "left the other at 12.0" in verdict.satellites[0].reason


def with_combo(combo, **changes):
    import dataclasses  # noqa: PLC0415

    log = simulate_log(Satellite())
    return dataclasses.replace(log, signals=(), combos=(dataclasses.replace(combo, **changes),))


def test_the_alarm_latches_after_the_drag_has_ended():
    combo = simulate_combo(Satellite())
    moved = np.clip(combo.time_s - 8.0, 0.0, 1.0) * 2.0
    log = with_combo(combo, phase_upper_cycles=combo.phase_upper_cycles + moved)
    alarm = only_alarm(detect(log))
    series = statistic(log.combos[0], DetectionConfig())
    quiet = series.time_s > 10.1
    assert np.all(np.abs(series.value[quiet]) < series.threshold(1e-6)[quiet])
    assert alarm.onset_s == pytest.approx(8.0, abs=0.06)


@pytest.mark.parametrize("drag_hz", [0.5, -8.0])
def test_a_difference_that_turned_all_along_began_no_later_than_its_piece(drag_hz):
    # As after a reacquisition: 6 s to 8 s are lost, and the signal found again is the spoofer's.
    combo = simulate_combo(Satellite())
    changes = {
        "phase_upper_cycles": combo.phase_upper_cycles + drag_hz * np.maximum(combo.time_s - 6, 0),
        "state": np.where(abs(combo.time_s - 7.0) < 1.0, State.LOST, combo.state),
    }
    config = RATE
    alarm = only_alarm(detect(with_combo(combo, **changes), config))
    assert alarm.onset_s == pytest.approx(8.0 + config.settle_s, abs=0.02)
    assert alarm.alarm_s == pytest.approx(alarm.onset_s + config.window_s, abs=0.02)


def test_a_band_that_is_lost_for_good_is_mentioned():
    combo = simulate_combo(Satellite())
    whole = detect(with_combo(combo)).satellites[0]
    lost = with_combo(combo, state=np.where(combo.time_s > 9.0, State.LOST, combo.state))
    (cut,) = detect(lost).satellites
    assert "only until" not in whole.reason
    assert "held together only until 9.00 of 20.00 s" in cut.reason


def test_the_same_log_gives_the_same_verdict():
    log = simulate_log(Satellite(attack=Attack()))
    assert detect(log) == detect(log)


def fit_rss(design, y):
    return np.sum((y - design @ np.linalg.lstsq(design, y)[0]) ** 2)


@pytest.mark.parametrize("at", [15, 60, 90])
@pytest.mark.parametrize("jump", [0.0, 0.3])
def test_change_point_is_the_brute_force_least_squares(at, jump):
    rng = np.random.default_rng(at)
    time = np.arange(100) * 0.01
    values = 0.02 * rng.standard_normal(100) + 3.0 * np.maximum(time - at * 0.01, 0)
    values[at:] += jump
    rows = np.arange(10, 97)
    line = np.vander(time, 2)
    if jump:
        brute = [fit_rss(line[:k], values[:k]) + fit_rss(line[k:], values[k:]) for k in rows]
    else:
        brute = [
            fit_rss(np.column_stack([line, np.maximum(time - time[k - 1], 0)]), values)
            for k in rows
        ]
    assert change_point(time, values) == rows[int(np.argmin(brute))]


@pytest.mark.parametrize("start_s", [6.95, 7.05, 7.9, 13.5])
def test_a_long_track_is_tested_in_sections_like_a_whole(monkeypatch, start_s):
    satellites = [
        Satellite(23, attack=Attack(start_s=start_s, drag_hz=0.5)),
        Satellite(24, lost=(6.5, 7.2), slips={14.02: ("B1I", 0.5)}),
        Satellite(25),
    ]
    log = simulate_log(*satellites)
    verdict, whole = detect(log), list(statistics(log, RATE))
    monkeypatch.setattr(windows, "SECTION_EPOCHS", 700)
    in_sections = list(statistics(log, RATE))
    assert len(in_sections) == 9
    for k, one in enumerate(whole):
        parts = in_sections[3 * k : 3 * k + 3]
        np.testing.assert_array_equal(np.concatenate([p.time_s for p in parts]), one.time_s)
        # The slips of a section are repaired by themselves: the phase differs, its slope does not.
        np.testing.assert_allclose(np.concatenate([p.value for p in parts]), one.value, atol=1e-9)
    again = detect(log)
    assert [s.verdict for s in again.satellites] == [s.verdict for s in verdict.satellites]
    a, b = only_alarm(again), only_alarm(verdict)
    assert (a.alarm_s, a.band) == (b.alarm_s, b.band)
    assert a.onset_s == pytest.approx(b.onset_s, abs=0.03)
    reasons = {s.prn: s.reason for s in again.satellites}
    assert "s on tracking in 2 pieces" in reasons[24]
    assert "1 cycle slip(s) repaired" in reasons[24]
    assert "held together only" not in reasons[25]


def test_one_band_only_is_not_enough_support():
    log = simulate_log(Satellite(23), single=[(Satellite(40), "B1CP"), (Satellite(7), "L1CA")])
    by_name = {(s.system, s.prn): s for s in detect(log).satellites}
    assert by_name["C", 23].verdict == "clean"
    assert by_name["C", 40].verdict == by_name["G", 7].verdict == "not enough support"
    assert "B1C only" in by_name["C", 40].reason


def test_a_gps_satellite_does_not_take_the_verdict_of_its_beidou_namesake():
    log = simulate_log(Satellite(23, attack=Attack()), single=[(Satellite(23), "L1CA")])
    verdicts = {s.system: s.verdict for s in detect(log).satellites}
    assert verdicts == {"C": "spoofed", "G": "not enough support"}


def test_too_short_a_recording_is_not_called_clean():
    (satellite,) = detect(simulate_log(Satellite(), duration_s=1.2)).satellites
    assert satellite.verdict == "not enough support"
    assert "0.70 s" in satellite.reason


def test_an_empty_log():
    verdict = detect(simulate_log())
    assert verdict.satellites == ()
    assert not verdict.spoofed


def test_unknown_rule_is_named():
    with pytest.raises(ConfigError, match="known rules: threshold"):
        decision.find("majority")
