"""From a recording: the captured band is isolated while tracking, whatever the blocks."""

import numpy as np
import pytest

from sdr_spoof.acquisition import acquire
from sdr_spoof.config import Config
from sdr_spoof.monitor import Monitor
from sdr_spoof.records import State
from sdr_spoof.scenario import builtin_scenario, synthesize
from sdr_spoof.sources import open_recording
from sdr_spoof.tracking import track


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("fallback") / "quick"
    return open_recording(synthesize(builtin_scenario("quick"), path))


def test_blocks_and_threads_do_not_matter(recording, tmp_path):
    config = Config()
    found = [a for a in acquire(recording, config.acquisition) if a.detected]
    runs = []
    for block_s, threads, rows_in in ((None, 1, None), (0.0371, 2, tmp_path)):
        monitor = Monitor(config.detection)
        log = track(
            recording,
            found,
            config.tracking,
            monitor=monitor,
            block_s=block_s,
            threads=threads,
            rows_in=rows_in,
        )
        runs.append((monitor.isolated, log))
    (one, a), (two, b) = runs
    assert [(i.signal, i.prn) for i in one] == [("B1CP", 27)]
    assert one == two
    for x, y in zip(a.signals, b.signals, strict=True):
        np.testing.assert_array_equal(x.carrier_phase_cycles, y.carrier_phase_cycles)
        np.testing.assert_array_equal(x.state, y.state)
    combo = next(c for c in a.combos if c.prn == 27)
    assert np.all(combo.state[combo.time_s > one[0].from_s + 0.05] == State.CAPTURED)
