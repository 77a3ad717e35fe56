"""Jump and slope of the phase difference: false alarms, detection, and what must not disturb it."""

import dataclasses

import numpy as np
import pytest
from simulated_tracks import Attack, Satellite, simulate_combo, simulate_log

from sdr_spoof.detectors import DetectionConfig, windows
from sdr_spoof.detectors.phase_difference_glr import plan_for, statistic, statistics
from sdr_spoof.detectors.slips import repair_every_slip
from sdr_spoof.records import State
from sdr_spoof.verdict import detect

CONFIG = DetectionConfig(detectors=("phase_difference_glr",))
TECU_CYCLES = 0.0156


@dataclasses.dataclass(frozen=True)
class Ramped(Attack):
    """A drag whose rate grows from nothing, by ``rate_hz_s``."""

    rate_hz_s: float = 1.0

    def apply(self, time_s):
        since = np.maximum(time_s - self.start_s, 0.0)
        ramp = np.minimum(since, abs(self.drag_hz) / self.rate_hz_s)
        turn = np.sign(self.drag_hz) * self.rate_hz_s * ramp * (since - 0.5 * ramp)
        turn = turn + self.phase_cycles
        total = 1 + self.amplitude * (time_s >= self.start_s) * np.exp(2j * np.pi * turn)
        return np.unwrap(np.angle(total)) / (2 * np.pi), np.abs(total)


def beyond(series):
    return np.abs(series.value) > series.threshold(1e-6)


def seen_within(attack, cn0_dbhz, seed, *, within_s=2.0, config=CONFIG):
    """Whether an attack is seen in time, and whether there was an alarm before it."""
    satellite = Satellite(cn0_dbhz=cn0_dbhz, attack=attack)
    combo = simulate_combo(satellite, duration_s=attack.start_s + within_s, seed=seed)
    series = statistic(combo, config)
    alarms = series.time_s[beyond(series)]
    return bool(np.any(alarms >= attack.start_s)), bool(np.any(alarms < attack.start_s))


@pytest.mark.parametrize("cn0_dbhz", [30.0, 45.0])
def test_false_alarms_come_no_more_often_than_stated(cn0_dbhz):
    # 3000 s at 60 alarms an hour; the bound leaves about half of them (alarm_rate).
    config = DetectionConfig(false_alarms_per_hour=60.0, min_cn0_dbhz=20.0)
    series = statistic(simulate_combo(Satellite(cn0_dbhz=cn0_dbhz), duration_s=3000.0), config)
    at = series.time_s[beyond(series)]
    alarms = int(at.size > 0) + np.count_nonzero(np.diff(at) > 4.0)
    expected = 60.0 * series.tested_s() / 3600
    assert 0.2 * expected < alarms < expected + 4 * np.sqrt(expected)


@pytest.mark.parametrize(("cn0_dbhz", "drag_hz"), [(30.0, 0.2), (45.0, 0.05)])
def test_slow_ramped_drags_are_seen_within_two_seconds(cn0_dbhz, drag_hz):
    for seed in range(30):
        attack = Ramped(
            band=("B1I", "B1CP")[seed % 2], start_s=13.0, drag_hz=drag_hz * (-1) ** (seed // 2)
        )
        assert seen_within(attack, cn0_dbhz, seed) == (True, False)


def test_a_spoofer_ten_decibels_below_is_seen_by_its_jump():
    # Random phase: only where it lies in phase or opposite does it turn the sum too little.
    config = DetectionConfig(false_alarms_per_hour=1.8)  # 1e-3 in two seconds
    phases = (np.arange(60) + 0.5) / 60
    attacks = [Attack(start_s=13.0, amplitude=10**-0.5, drag_hz=0, phase_cycles=p) for p in phases]
    seen = [seen_within(a, 45.0, k, config=config)[0] for k, a in enumerate(attacks)]
    assert np.mean(seen) > 0.9
    assert all(s for s, p in zip(seen, phases, strict=True) if abs(np.sin(2 * np.pi * p)) > 0.2)


@pytest.mark.parametrize("drag_hz", [0.1, -2.0])
def test_onset_and_band(drag_hz):
    attacked = Satellite(23, attack=Attack(band="B1I", start_s=14.0, drag_hz=drag_hz))
    verdict = detect(simulate_log(attacked, Satellite(24)), CONFIG)
    (alarm,) = [a for s in verdict.satellites for a in s.alarms]
    # The slow drag is seen before a carrier has left its own course by enough to be named: later.
    assert (alarm.prn, alarm.band) == (23, "B1I")
    assert alarm.onset_s == pytest.approx(14.0, abs=0.02 + 0.02 / abs(drag_hz))
    assert alarm.onset_s <= alarm.alarm_s < 15.0


@pytest.mark.parametrize(
    ("band", "cycles"), [("B1I", 0.5), ("B1I", -1.0), ("B1CP", 1.0), ("B1CP", -2.0)]
)
@pytest.mark.parametrize("cn0_dbhz", [30.0, 45.0])
def test_a_slip_is_no_alarm(band, cycles, cn0_dbhz):
    log = simulate_log(Satellite(cn0_dbhz=cn0_dbhz, slips={14.0: (band, cycles)}))
    (satellite,) = detect(log, CONFIG).satellites
    assert satellite.verdict == "clean"
    assert "1 cycle slip(s) repaired" in satellite.reason


def test_slips_in_a_burst_are_no_alarm():
    # A slipping Costas loop hops to and fro; then it stays half a cycle further.
    hops = {14.0: 0.5, 14.02: -0.5, 14.05: 0.5, 14.5: 0.5, 14.8: -1.0}
    slips = {at: ("B1I", size) for at, size in hops.items()}
    assert not detect(simulate_log(Satellite(cn0_dbhz=35.0, slips=slips)), CONFIG).spoofed


@pytest.mark.parametrize(("band", "cycles"), [("B1CP", 0.5), ("B1I", 0.25), ("B1I", 0.45)])
def test_a_jump_that_is_no_slip_is_an_alarm(band, cycles):
    log = simulate_log(Satellite(slips={14.0: (band, cycles)}))
    (satellite,) = detect(log, CONFIG).satellites
    assert satellite.verdict == "spoofed"
    assert satellite.alarms[0].onset_s == pytest.approx(14.0, abs=0.02)


def test_a_beat_of_equal_signals_is_an_alarm_though_its_flips_look_like_slips():
    attack = Attack(band="B1I", start_s=14.0, amplitude=0.98, drag_hz=1.5)
    assert detect(simulate_log(Satellite(attack=attack)), CONFIG).spoofed


def test_motion_clock_and_ionosphere_are_no_alarm():
    combo = simulate_combo(
        Satellite(cn0_dbhz=50.0, doppler_hz=4000.0, doppler_rate_hz_s=1.0), duration_s=120.0
    )
    clock = 1.5 * combo.time_s + 0.01 * combo.time_s**2
    ionosphere = 0.19 / 60 * TECU_CYCLES * combo.time_s  # 0.19 TECU a minute
    changed = dataclasses.replace(
        combo,
        phase_lower_cycles=combo.phase_lower_cycles + clock * 1561.098 / 1575.42,
        phase_upper_cycles=combo.phase_upper_cycles + clock + ionosphere,
    )
    assert not beyond(statistic(changed, CONFIG)).any()


def test_a_gap_and_what_follows_it_are_no_alarm():
    combo = simulate_combo(Satellite(lost=(14.0, 14.5)), duration_s=40.0)
    series = statistic(combo, CONFIG)
    assert not beyond(series).any()
    shortest_s = plan_for(0.01, CONFIG).shortest * 0.01
    held = (series.time_s < 14.01) | (series.time_s > 14.5 + CONFIG.settle_s + shortest_s - 0.02)
    assert held.all()
    assert set(series.segment) == {0, 1}


def test_a_fading_signal_is_no_alarm():
    strong, weak = (simulate_combo(Satellite(cn0_dbhz=c), duration_s=40.0) for c in (45.0, 35.0))
    late = strong.time_s > 20.0
    names = [n for n in strong.columns() if "phase" in n or "cn0" in n]
    faded = {n: np.where(late, getattr(weak, n), getattr(strong, n)) for n in names}
    assert not beyond(statistic(dataclasses.replace(strong, **faded), CONFIG)).any()


def test_weak_signals_and_short_tracks_have_no_support():
    weak = statistic(simulate_combo(Satellite(cn0_dbhz=25.0)), CONFIG)
    short = statistic(simulate_combo(Satellite(), duration_s=2.4), CONFIG)
    assert weak.time_s.size == short.time_s.size == 0
    assert "2.10 s are needed" in short.notes[-1]
    empty = simulate_combo(Satellite(lost=(0.0, 99.0)))
    assert statistic(empty, CONFIG).time_s.size == 0


def test_a_long_track_is_tested_in_sections_like_a_whole(monkeypatch):
    log = simulate_log(Satellite(23, lost=(26.5, 27.2), slips={14.02: ("B1I", 0.5)}), duration_s=60)
    (whole,) = statistics(log, CONFIG)
    monkeypatch.setattr(windows, "SECTION_EPOCHS", 2345)
    parts = list(statistics(log, CONFIG))
    assert len(parts) == 3
    np.testing.assert_array_equal(np.concatenate([p.time_s for p in parts]), whole.time_s)
    np.testing.assert_allclose(np.concatenate([p.value for p in parts]), whole.value, atol=1e-6)


def test_noise_makes_no_slips():
    rng = np.random.default_rng(8)
    noise = 0.045 * rng.standard_normal(100_000)
    repaired, count = repair_every_slip(noise, 0.5, 0.045)
    assert count == 0
    np.testing.assert_array_equal(repaired, noise)


def test_two_noisy_rows_are_no_pair_of_slips():
    # Each is over a quarter of a cycle off: removed as hops, all rows between would be moved.
    noise = 0.045 * np.random.default_rng(9).standard_normal(400)
    noise[[200, 218]] = 0.27
    repaired, _ = repair_every_slip(noise, 0.5, 0.045)
    assert np.max(np.abs(repaired[201:218] - noise[201:218])) < 0.01


@pytest.mark.parametrize("seed", range(12))
def test_a_slow_slip_in_much_noise_is_taken_out(seed):
    """At 25 dB-Hz noise makes hops of its own beside those of a loop that lingers half-way."""
    rng = np.random.default_rng(seed)
    sigma, turned = 0.068, np.interp(np.arange(400), [190, 215], [0.0, 0.5])
    discriminator = sigma * rng.standard_normal(400) - turned
    measured = turned + discriminator - 0.5 * np.round(discriminator / 0.5)
    repaired, count = repair_every_slip(measured, 0.5, sigma)
    assert count >= 1
    ends = repaired[:180].mean(), repaired[225:].mean()
    assert abs(ends[0] - ends[1]) < 4 * sigma * np.sqrt(2 / 175)


def test_a_lost_row_breaks_the_piece():
    combo = simulate_combo(Satellite())
    state = combo.state.copy()
    state[1500] = State.LOST
    assert set(statistic(dataclasses.replace(combo, state=state), CONFIG).segment) == {0, 1}
