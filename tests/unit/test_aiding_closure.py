"""Perfect increments along drawn motions bring the INS back to the truth after 1750 s."""

import numpy as np
import pytest
from pydantic import TypeAdapter

from sdr_spoof.aiding import strapdown
from sdr_spoof.aiding.imu.simulate import ideal_increments, true_states
from sdr_spoof.scenario.sky.receiver import AnyReceiver

SECONDS = 1750


@pytest.mark.parametrize("kind", ["vehicle", "uav", "ship"])
def test_it_closes(kind):
    table = {"kind": kind, "seed": 1, "latitude_deg": 34.0, "longitude_deg": 108.0}
    table |= {"height_m": 400.0}
    path = TypeAdapter(AnyReceiver).validate_python(table).trajectory(SECONDS + 10.0)
    log = ideal_increments(path, SECONDS, 100.0)
    truth = true_states(path, np.array([0.0, SECONDS]))
    found = strapdown.navigate(log, strapdown.row(truth, 0), every=100 * SECONDS)
    assert np.linalg.norm(found.velocity_m_s[-1] - truth.velocity_m_s[-1]) < 1e-4
    assert np.linalg.norm(found.position_m[-1] - truth.position_m[-1]) < 0.05
