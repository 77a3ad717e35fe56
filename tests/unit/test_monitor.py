"""Watching while tracking: the captured band is isolated, and nothing else ever is."""

import numpy as np
import pytest

from sdr_spoof.correlator_level import simulate
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.monitor import Monitor
from sdr_spoof.records import State
from sdr_spoof.scenario import Scenario, builtin_scenario, transmissions
from sdr_spoof.tracking import TrackingConfig
from sdr_spoof.verdict import detect

ATTACKED = 27


def scenario(signals=("B1C",), *, attacked=True, duration_s=6.0, **changes):
    """The quick scenario with the attack on these bands."""
    plain = builtin_scenario("quick").model_dump()
    plain["recording"]["duration_s"] = duration_s
    attack = {**plain["attack"][0], "signals": list(signals), **changes}
    plain["attack"] = [attack] if attacked else []
    return Scenario.model_validate(plain)


def watched(plan, config=None, **more):
    """(monitor, log) of a run."""
    monitor = Monitor(DetectionConfig())
    return monitor, simulate(plan, config, monitor=monitor, **more)


def combo_of(log):
    return next(c for c in log.combos if c.prn == ATTACKED)


@pytest.mark.parametrize(("composite", "signal"), [("B1C", "B1CP"), ("B1I", "B1I")])
@pytest.mark.parametrize("seed", [1, 2])
def test_the_captured_band_is_isolated_once(composite, signal, seed):
    monitor, log = watched(scenario([composite]), seed=seed)
    (isolation,) = monitor.isolated
    assert (isolation.signal, isolation.prn) == (signal, ATTACKED)
    assert isolation.from_s == round(isolation.from_s) <= 4.0
    combo = combo_of(log)
    after = combo.time_s > isolation.from_s + 0.05
    assert np.all(combo.state[after] == State.CAPTURED)
    assert not np.any(combo.state[(combo.time_s < isolation.from_s - 0.05)] == State.CAPTURED)
    satellite = next(s for s in detect(log).satellites if s.prn == ATTACKED)
    assert (satellite.verdict, satellite.band) == ("spoofed", signal)


@pytest.mark.parametrize("seed", [1, 2])
def test_nothing_is_isolated_without_an_attack(seed):
    monitor, log = watched(scenario(attacked=False, duration_s=9.0), seed=seed)
    assert monitor.isolated == []
    assert all(s.verdict == "clean" for s in detect(log).satellites)


def test_an_attack_on_both_bands_isolates_none():
    monitor, _ = watched(scenario(["B1I", "B1C"]))
    assert monitor.isolated == []


def test_the_setting_turns_it_off():
    monitor, log = watched(scenario(), TrackingConfig(fallback=False))
    assert monitor.isolated == []
    assert State.CAPTURED not in combo_of(log).state


def test_threads_change_nothing():
    (one, a), (two, b) = watched(scenario(), threads=1), watched(scenario(), threads=3)
    assert one.isolated == two.isolated
    for x, y in zip(a.signals, b.signals, strict=True):
        np.testing.assert_array_equal(x.carrier_phase_cycles, y.carrier_phase_cycles)


def test_the_sideband_that_stays_follows_the_truth_within_thermal_noise():
    plan = scenario()
    monitor, log = watched(plan)
    (isolation,) = monitor.isolated
    track = next(t for t in log.signals if (t.prn, t.signal) == (ATTACKED, "B1I"))
    emitter = next(t.emitter for t in transmissions(plan) if (t.prn, t.signal) == (ATTACKED, "B1I"))
    # Measured phase grows with range, the received one with time: their sum is constant.
    off = track.carrier_phase_cycles + emitter.received_phase_cycles(track.time_s)
    quiet = (track.time_s > 1.0) & (track.time_s < 1.4) & (track.state >= State.SYNCED)
    after = track.time_s > isolation.from_s
    off -= np.round(2 * (np.median(off[after]) - np.median(off[quiet]))) / 2 * after
    snr = 10 ** (np.median(track.cn0_dbhz) / 10) * 0.01
    sigma = np.sqrt((1 + 1 / (2 * snr)) / (2 * snr)) / (2 * np.pi)
    error = off[after] - np.mean(off[quiet])
    assert np.std(error) == pytest.approx(sigma, rel=0.1)
    assert abs(np.mean(error)) < 4 * sigma / np.sqrt(np.count_nonzero(quiet)) + 1e-3
    code = track.code_phase_chips - emitter.code_phase_chips(track.time_s)
    drift = np.median(code[after]) - np.median(code[quiet])
    assert abs(drift - np.round(drift)) < 0.02
