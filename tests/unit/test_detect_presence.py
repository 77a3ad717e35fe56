"""A signal that goes away is no attack: rows without signal stay out of the tests."""

import numpy as np
import pytest
from simulated_tracks import Satellite, sideband, simulate_combo

from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.detectors.presence import empty, present
from sdr_spoof.records import State, TrackLog
from sdr_spoof.scenario import Scenario
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.studies.tracking import scenario, seeds
from sdr_spoof.tracking import TrackingConfig, track
from sdr_spoof.verdict import detect

GONE_S = 2.0


class Blocked(LiveRecording):
    """A live scenario, another one from ``GONE_S`` on."""

    def __init__(self, plan: Scenario, after: Scenario) -> None:
        super().__init__(plan, threads=1)
        self._after = LiveRecording(after, threads=1)

    def read_raw(self, start, count):
        change = round(GONE_S * self.format.sample_rate_hz)
        if start >= change:
            return self._after.read_raw(start, count)
        first = super().read_raw(start, min(count, change - start))
        rest = max(start + count - change, 0)
        return np.concatenate([first, self._after.read_raw(change, rest)])


@pytest.fixture(scope="module")
def blocked_log():
    """Six satellites at 45 dB-Hz; at 2 s three lose both signals and three lose B1C."""
    plan = scenario(45.0, 3.0)
    dump = plan.model_dump()
    dump["recording"]["sample_rate_hz"] = 20e6
    plan = Scenario.model_validate(dump)
    left = [dict(s, signals=["B1I"]) for s in dump["satellite"][::2]]
    after = Scenario.model_validate(dict(dump, satellite=left))
    config = TrackingConfig(reacquire=False)
    return track(Blocked(plan, after), seeds(plan), config, threads=1)


@pytest.mark.parametrize("model", ["published", "thermal"])
def test_satellites_that_vanish_raise_no_alarm(blocked_log, model):
    verdict = detect(blocked_log, DetectionConfig(threshold_model=model, settle_s=0.2))
    assert [s.alarms for s in verdict.satellites] == [()] * 6
    # Half a second before they went was tested, so the silence is not for want of tests.
    config = DetectionConfig(threshold_model=model, settle_s=0.2, min_tested_s=0.5, window_s=0.5)
    assert {s.verdict for s in detect(blocked_log, config).satellites} == {"clean"}


def test_rows_between_the_loss_and_its_detection_are_empty(blocked_log):
    for combo in blocked_log.combos:
        there = present(blocked_log, combo, 28.0)
        gone = combo.time_s > GONE_S + 0.01
        # The loops ran on for tenths of a second: that is what has to be left out.
        assert np.count_nonzero(gone & (combo.state >= State.SYNCED)) > 5
        assert not np.any(there & gone)
        assert np.all(there[combo.time_s < GONE_S - 0.15])


def test_weak_signals_are_there():
    # 30 dB-Hz in 10 ms epochs: prompts and noise drawn from their law, 1000 s of it.
    rng = np.random.default_rng(3)
    combo = simulate_combo(Satellite(cn0_dbhz=30.0), duration_s=1000.0)
    plain = sideband(combo, "B1I")
    count = combo.time_s.size
    noise = (rng.standard_normal((count, 2)) + 1j * rng.standard_normal((count, 2))) / np.sqrt(2)
    amplitude = np.sqrt(10**3.0 * 0.01)
    taps = (noise + np.array([amplitude, 0.0])).astype(np.complex64)
    tap_offsets_s = np.array([0.0, -5.5 / 2.046e6])
    fields = {**vars(plain), "taps": taps, "tap_offsets_s": tap_offsets_s, "prompt_tap": 0}
    assert np.mean(empty(type(plain)(**fields), 25.0)) < 1e-3
    fields["taps"] = noise.astype(np.complex64)
    assert np.all(empty(type(plain)(**fields), 25.0))


def test_without_tracks_or_noise_tap_all_rows_count():
    combo = simulate_combo(Satellite())
    log = TrackLog("x", 120e6, 20.0, False, (), (combo,))
    assert present(log, combo, 28.0).all()
    log = TrackLog("x", 120e6, 20.0, False, (sideband(combo, "B1I"),), (combo,))
    assert present(log, combo, 28.0).all()
