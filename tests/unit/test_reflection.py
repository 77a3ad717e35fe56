"""What an echo can do and what it cannot, at correlator level."""

import pytest

from sdr_spoof import reflection
from sdr_spoof.correlator_level import simulate
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.satellites import tracks_of
from sdr_spoof.scenario import Scenario
from sdr_spoof.verdict import detect

CONFIG = DetectionConfig()
BOTH = ["B1I", "B1C"]
ECHO = {"ratio": 0.5, "delay_m": 20.0, "start_s": 12.0, "rise_s": 1.0}
DRAG = {
    "prn": 27,
    "start_s": 12.0,
    "eta": 1.5,
    "power_ramp_s": 2.0,
    "drag_start_s": 15.0,
    "drag_rate_m_s": 5.0,
    "carrier_phase_cycles": "aligned",
}
SEAMLESS = {
    "prn": 27,
    "signals": BOTH,
    "start_s": 12.0,
    "takeover": "seamless",
    "power_ramp_s": 2.0,
    "eta": 2.0,
    "drag_start_s": 15.0,
    "drag_rate_m_s": 5.0,
    "drag_eta": 1.0,
    "carrier": "frequency-locked",
}


def log_of(attack, seed=1, duration_s=24.0):
    recording = {
        "duration_s": duration_s,
        "sample_rate_hz": 25e6,
        "lo_hz": 1568.259e6,
        "sample_format": "ci8",
        "bandwidth_hz": 22e6,
    }
    satellite = {"prn": 27, "range_rate_m_s": 96.1, "delay_ms": 74.263}
    values = {"recording": recording, "satellite": [satellite], "attack": [attack]}
    return simulate(Scenario.model_validate(values), seed=seed)


def verdict_of(attack, seed=1, **more):
    (satellite,) = detect(log_of(attack, seed, **more), CONFIG).satellites
    return satellite


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_an_echo_that_moves_is_a_suspicion(seed):
    ray = ECHO | {"delay_rate_m_s": 0.5}
    satellite = verdict_of({"kind": "multipath", "prn": 27, "ray": [ray]}, seed)
    assert satellite.verdict == "suspect"
    assert "a reflection does this too" in satellite.reason


@pytest.mark.parametrize("signals", [["B1I"], ["B1C"], BOTH])
def test_a_drag_is_spoofing(signals):
    assert verdict_of(DRAG | {"signals": signals}).verdict == "spoofed"


def test_a_code_that_leaves_for_ever_in_both_bands_is_spoofing():
    # No power rises and the phase difference does not turn.
    log = log_of(SEAMLESS, duration_s=40.0)
    (satellite,) = detect(log, CONFIG).satellites
    assert satellite.verdict == "spoofed"
    for track in tracks_of(log, "C", 27):
        reach_m = reflection.code_reach_m(track, 12.0, CONFIG)
        assert reach_m > 3e8 * reflection.half_spacing_s(track)


def test_how_far_an_echo_and_a_captured_carrier_go():
    ray = ECHO | {"delay_rate_m_s": 0.5, "ratio": 0.6}
    echo = log_of({"kind": "multipath", "prn": 27, "ray": [ray]})
    assert reflection.phase_reach(echo, ("C", 27), 12.0, CONFIG) < reflection.PHASE_REACH_CYCLES
    drag = log_of(DRAG | {"signals": ["B1C"], "drag_rate_m_s": 0.5})
    assert reflection.phase_reach(drag, ("C", 27), 12.0, CONFIG) > 10.0
    for track in tracks_of(echo, "C", 27):
        reach_m = reflection.code_reach_m(track, 12.0, CONFIG)
        assert 1.0 < reach_m < 3e8 * reflection.half_spacing_s(track)


def test_a_quiet_satellite_goes_nowhere():
    log = log_of({"kind": "multipath", "prn": 27, "ray": [ECHO | {"start_s": 23.9}]})
    assert reflection.phase_reach(log, ("C", 27), 12.0, CONFIG) < 0.02
    assert reflection.bent(log, ("C", 27), ()) == []
