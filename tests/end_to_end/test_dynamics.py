"""Acceleration: what the loops hold, and that neither motion nor its loss looks like an attack."""

import pytest

from sdr_spoof import acquire, detect, load_config, track
from sdr_spoof.records import State
from sdr_spoof.scenario import Scenario
from sdr_spoof.scenario.live import LiveRecording

WIDE = {
    "tracking.pll_bandwidth_hz": "25",
    "tracking.main_bandwidth_hz": "25",
    "tracking.pull_in_pll_bandwidth_hz": "30",
}
HELD, LOST = "clean", "not enough support"


@pytest.mark.parametrize(
    ("acceleration_m_s2", "flags", "verdict"),
    [
        (15.0, {}, HELD),
        (-15.0, {}, HELD),
        (30.0, {}, LOST),
        (30.0, WIDE, HELD),
        (-30.0, WIDE, HELD),
    ],
)
def test_acceleration_is_held_or_the_satellite_is_not_judged(acceleration_m_s2, flags, verdict):
    plan = {"duration_s": 3.5, "sample_rate_hz": 25e6, "lo_hz": 1568.259e6, "sample_format": "ci8"}
    satellite = {"prn": 27, "range_rate_m_s": 96.1, "range_acceleration_m_s2": acceleration_m_s2}
    recording = LiveRecording(Scenario(recording=plan, satellite=[satellite]))
    config = load_config(flags=flags)
    found = acquire(recording, config.acquisition, signals=["B1I", "B1CP"], prns=[27])
    log = track(recording, found, config.tracking)
    assert [s.verdict for s in detect(log, config.detection).satellites] == [verdict]
    assert all((t.state != State.LOST).all() for t in log.signals) == (verdict == HELD)
