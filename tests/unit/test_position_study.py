"""The study of positions: the whole chain on two seconds of a small sky."""

from __future__ import annotations

import math

import pytest

from sdr_spoof.config import load_config
from sdr_spoof.scenario import Scenario, builtin_scenario
from sdr_spoof.scenario.load import scenario_path
from sdr_spoof.studies import position, position_first

HOT = {
    "navigation.files": str(scenario_path("sky-static").with_name("brdc-2023-03-12.rnx")),
    "navigation.time": "2023-03-12T12:00:00",
    "navigation.place": "31.3,121.4,0",
    "observables.rate_hz": "10",
}


@pytest.fixture(scope="module")
def received(tmp_path_factory):
    """Received from samples with one thread and with two."""
    values = builtin_scenario("sky-static").model_dump()
    values["recording"] |= {"duration_s": 2.0, "sample_rate_hz": 5e6, "bandwidth_hz": 4.5e6}
    values["sky"]["elevation_mask_deg"] = 40.0
    plan = Scenario.model_validate(values)
    folder = tmp_path_factory.mktemp("position")
    found = position.from_samples(plan, load_config(flags=HOT), folder, (1, 2))
    assert not list(folder.iterdir())
    return plan, found


def test_the_same_fixes_with_any_number_of_threads(received):
    _, (one, two) = received
    assert one.located.fixes.fixed.any()
    assert position.alike(one.located, two.located)


def test_errors_are_those_against_the_truth(received):
    plan, (one, _) = received
    found = position.accuracy_of("static B1I", plan, one, position.errors_of(one))
    assert found.satellites >= 5 and found.losses == 0 and found.spoofed == 0
    # Seven satellites high in the sky, half a second of the code loop: 4 standard errors.
    assert 0.0 < found.horizontal_m < 4.0 and found.velocity_m_s < 0.5


def test_the_shortest_start_that_gives_a_fix(received):
    _, (one, _) = received
    hot = position_first.shortest_s(one.log, load_config(flags=HOT), 2.0)
    assert 0.0 < hot <= 2.0
    assert math.isnan(position_first.shortest_s(one.log, load_config(), 2.0))
