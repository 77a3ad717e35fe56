"""Whether IMU and GNSS fit from the beginning, and what that makes of a verdict."""

from __future__ import annotations

import dataclasses

import aided_case as case
import aided_ship as ship
import numpy as np
import pytest

from sdr_spoof.aided.judge import doubted
from sdr_spoof.aided.rates import Rates, joined
from sdr_spoof.aided.run import aid
from sdr_spoof.aided.session import with_lever_arm
from sdr_spoof.aided.swing import swing
from sdr_spoof.aiding import simulated as sim
from sdr_spoof.aiding.imu.readers import ImuReading, read_imu, table
from sdr_spoof.aiding.imu.simulate import true_states
from sdr_spoof.aiding.rate_config import RateConfig
from sdr_spoof.config import Config
from sdr_spoof.errors import InertialError
from sdr_spoof.report import aided_words as words
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory

RATE = RateConfig(carrier_sigma_m=0.005)


def rolling(time_s):
    """Yaw, pitch, roll of a ship in a swell."""
    return np.stack(
        [0.3 * np.sin(time_s / 9), 0.05 * np.sin(time_s), 0.1 * np.sin(0.7 * time_s)], 1
    )


SEA = Trajectory(OnPlane(ship.ORIGIN, ship.way), rolling, ship.LEVER_ARM)


def found(arm=ship.LEVER_ARM, late_s=0.0, seed=1):
    """By 60 epochs and an INS without errors, whose clock is late."""
    sky = sim.fixed(ship.TIME[:60], SEA.position_m(np.zeros(1))[0], ship.LOOKS)
    seen = sim.simulate(SEA, sky, ship.TIME[:60], seed=seed, reference=ship.REFERENCE).run()
    at_s = np.arange(0.0, 62.0, 0.1)
    states = true_states(SEA, at_s)
    states = dataclasses.replace(
        states, reference=ship.REFERENCE, time_s=at_s + late_s, aligned_s=at_s
    )
    return swing(dataclasses.replace(seen, lever_arm_m=arm), states, RATE)


def test_the_arm_in_use_is_right():
    for seed in range(5):
        right = found(seed=seed)
        assert not right.arm_wrong and not right.clock_wrong
        off = (np.array(right.arm_m) - ship.LEVER_ARM) / right.arm_sigma_m
        assert (np.abs(off) < 4).all()
        assert abs(right.clock_s) < 4 * right.clock_sigma_s


def test_another_arm_is_found():
    wrong = found(arm=(0.0, 0.0, 0.0))
    assert wrong.arm_wrong and not wrong.clock_wrong
    off = np.array(wrong.arm_m) - ship.LEVER_ARM
    assert (np.abs(off) < 4 * np.array(wrong.arm_sigma_m)).all()
    assert max(wrong.arm_sigma_m) < 0.5 and wrong.arm_share > 0.9


def test_a_clock_that_is_off_is_found():
    late = found(late_s=0.3)
    assert late.clock_wrong and late.clock_share > late.arm_share
    assert late.clock_s == pytest.approx(0.3, abs=4 * late.clock_sigma_s + 0.01)


def test_too_little_tells_nothing():
    sky = sim.fixed(ship.TIME[:9], SEA.position_m(np.zeros(1))[0], ship.LOOKS)
    seen = sim.simulate(SEA, sky, ship.TIME[:9], reference=ship.REFERENCE).run()
    states = dataclasses.replace(true_states(SEA, ship.TIME[:9]), reference=ship.REFERENCE)
    assert swing(seen, states, RATE) is None


def test_who_is_named_is_spoofed_all_the_same():
    """The others agree with the IMU, which so cannot be wrong."""
    named = case.aided().verdict
    assert doubted(named, "why").verdict == "spoofed"
    assert doubted(named, "why").notes == ("why", "one note")
    nobody = dataclasses.replace(named, satellites=(), everybody=True)
    told = doubted(nobody, "the arm is wrong")
    assert told.verdict == "suspect" and told.doubt == "the arm is wrong"
    assert told.reason.endswith("; but the arm is wrong, and judge again")
    assert words.action(told).startswith("mend what does not fit, and judge again")
    clean = dataclasses.replace(named, verdict="clean", satellites=())
    assert doubted(clean, "why").verdict == "clean"


def test_a_real_attack_is_not_excused():
    for satellites in (ship.ATTACKED, None):
        attack = sim.velocity_drag((1.0, 0.0, 0.0), 80.0, 120.0, satellites=satellites)
        verdict = aid(ship.measured(attack), ship.increments(), ship.config()).verdict
        assert verdict.verdict == "spoofed" and not verdict.doubt


def test_a_gap_of_the_imu_begins_a_new_ins():
    log = ship.increments()
    first, last = np.searchsorted(log.time_s, [55.0, 58.0])
    keep = np.r_[0:first, last : log.time_s.size]
    holed = dataclasses.replace(
        log,
        time_s=log.time_s[keep],
        rotation_rad=log.rotation_rad[keep],
        velocity_m_s=log.velocity_m_s[keep],
    )
    got = aid(ship.measured(), holed, ship.config())
    assert got.verdict.verdict == "clean"
    drag = next(m for m in got.monitors if m.name.startswith("Drag"))
    tested = np.isfinite(drag.value)
    assert drag.time_s.size == ship.TIME.size
    # From 30 s on to the gap, and 30 s after it again.
    assert tested[53] and not tested[56:88].any() and tested[115:].all()
    age_s = got.inertial.aligned_s
    assert (np.diff(age_s) < 0).sum() == 1 and got.inertial.time_s[age_s == 0].tolist() == [30, 88]


def test_parts_are_joined_by_name():
    early = case.monitor("east", alarm_s=62.0, log10_p=-9.0)
    late = dataclasses.replace(case.monitor("east"), time_s=case.TIME[60:], log10_p=0.0)
    late = dataclasses.replace(late, value=late.value[60:], threshold=late.threshold[60:])
    head = dataclasses.replace(
        early, time_s=case.TIME[:30], value=early.value[:30], threshold=early.threshold[:30]
    )
    parts = [Rates((m,), (), ("note",), ("limit",), 2.0) for m in (head, late)]
    whole = joined(parts, case.TIME)
    (one,) = whole.monitors
    assert one.alarm_s == 62.0 and one.log10_p == -9.0
    assert np.isnan(one.value[30:60]).all() and np.isfinite(one.value[60:]).all()
    assert whole.notes == ("note",) and whole.tests == 4.0


def reading(told):
    return ImuReading(ship.increments(), "csv", (), told)


@pytest.mark.parametrize(
    ("given", "told", "used", "note"),
    [
        (None, None, (0.0, 0.0, 0.0), "no lever arm is known"),
        (None, (1.0, 2.0, -3.0), (1.0, 2.0, -3.0), "lever arm of 1,2,-3 m"),
        ((1.0, 2.0, -3.0), None, (1.0, 2.0, -3.0), None),
        ((1.0, 2.0, -3.0), (1.0, 2.0, -3.01), (1.0, 2.0, -3.0), None),
        ((1.0, 2.0, -3.0), (1.0, 2.0, 3.0), (1.0, 2.0, -3.0), "the IMU's file says 1,2,3 m"),
    ],
)
def test_whose_lever_arm(given, told, used, note):
    config = Config.model_validate({"imu": {} if given is None else {"lever_arm_m": given}})
    config, notes = with_lever_arm(config, reading(told))
    assert config.imu.lever_arm_m == used
    assert len(notes) == (note is not None) and all(note in n for n in notes)


def test_a_file_tells_its_lever_arm(tmp_path):
    path = tmp_path / "imu.csv"
    path.write_text(table.text(ship.increments(), (1.0, -2.5, 0.0)))
    assert read_imu(path).lever_arm_m == (1.0, -2.5, 0.0)
    path.write_text(table.text(ship.increments()))
    assert read_imu(path).lever_arm_m is None
    path.write_text("# lever_arm_m: 1, 2\n" + table.text(ship.increments()))
    with pytest.raises(InertialError, match="is not three numbers in m: give forward, right, down"):
        read_imu(path)
