"""A scenario with an IMU through receiver, filter and exclusion: induced spoofing of three."""

from __future__ import annotations

import numpy as np
import pytest

from sdr_spoof import simulate
from sdr_spoof.aided.run import aid
from sdr_spoof.aiding import measurements
from sdr_spoof.config import Config
from sdr_spoof.positioning import locate
from sdr_spoof.scenario import builtin_scenario
from sdr_spoof.scenario.imu_data import imu_of
from sdr_spoof.scenario.sky.orbits import DEFAULT

ATTACKED = ("C07", "C20", "C40")


@pytest.fixture(scope="module")
def ship():
    """The receiver's own loops at correlator level, and the IMU of the same scenario."""
    scenario = builtin_scenario("ship-quick")
    return scenario.sky_model(), imu_of(scenario), simulate(scenario)


def aided(ship, **tight):
    sky, imu, log = ship
    attitude = np.degrees(sky.trajectory.attitude_rad(np.ones(1)))[0].tolist()
    near = {"files": [str(DEFAULT)], "time": "2023-03-12T12:00:00", "place": [31.2, 121.9, 15.0]}
    config = Config.model_validate(
        {
            "tight": tight,
            "aided": {"grade": "ship-a", "attitude_deg": attitude},
            "navigation": near,
        }
    )
    located = locate(log, config)
    measured = measurements.of(
        located.observations,
        located.navigation,
        config.pvt,
        lever_arm_m=sky.trajectory.lever_arm_m,
    )
    found = aid(measured, imu.log, config)
    true_m = sky.trajectory.position_m(measured.time_s + (measured.reference - sky.start))
    return found, [
        np.linalg.norm(place - true_m, axis=1)
        for place in (found.track.position_m, found.track.alone_m)
    ]


def test_the_place_stays_while_gnss_alone_is_led_away(ship):
    found, (with_ins, alone) = aided(ship)
    assert found.verdict.verdict == "spoofed"
    assert found.verdict.satellites == ATTACKED
    assert 125.0 < found.verdict.onset_s < 137.0
    assert with_ins.max() < 5.0
    assert alone.max() > 50.0


def test_without_exclusion_the_place_goes_along(ship):
    found, (with_ins, _) = aided(ship, exclusion="off")
    assert with_ins.max() > 20.0
    # The tests of rates see it none the less.
    assert found.verdict.verdict == "spoofed" and not found.verdict.satellites
