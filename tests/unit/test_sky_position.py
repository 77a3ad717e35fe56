"""A false position."""

import math
from typing import Any

import numpy as np
import pytest
import sky_reference as reference
from attacks import added, authentic, difference
from skies import PLACE, satellite, sky

from sdr_spoof.correlator_level import simulate
from sdr_spoof.nav.geodesy import enu_matrix, geodetic_to_ecef
from sdr_spoof.scenario import Scenario, builtin_scenario, truth
from sdr_spoof.scenario.knots import Knots
from sdr_spoof.scenario.knots import added as sum_of
from sdr_spoof.signals import signal_spec

C = 299_792_458.0
ANTENNA = geodetic_to_ecef([31.2, 121.5, 30.0])
ATTACK: dict[str, Any] = {
    "kind": "position",
    "start_s": 0.5,
    "power_ramp_s": 0.5,
    "power_db": 6.0,
    "carrier_phase_cycles": "aligned",
    "drag_start_s": 1.5,
    "drag_ramp_s": 1.0,
    "velocity_enu_m_s": (30.0, 40.0, 5.0),
}


def made(**change: Any) -> Scenario:
    return sky(attack=ATTACK | change, elevation_mask_deg=30.0, clock={"drift_ppb": 300.0})


@pytest.mark.parametrize(("system", "prn", "signal"), [("C", 30, "B1CP"), ("G", 25, "L1CA")])
def test_counterfeits_are_what_the_false_place_would_receive(
    system: str, prn: int, signal: str
) -> None:
    scenario = sky(attack=ATTACK)
    start = scenario.sky_model().start  # type: ignore[union-attr]
    track = satellite(scenario, system, prn).track
    counterfeit = next(
        t for t in added(scenario, prn, signal) if (t.system, t.prn) == (system, prn)
    )
    # 0.5 s of growth, then 1 s at full speed.
    for at_s, moved_s in ((1.0, 0.0), (2.0, 0.125), (3.5, 1.5)):
        place = ANTENNA + moved_s * np.array([30.0, 40.0, 5.0]) @ enu_matrix(31.2, 121.5)
        way_m, clock_s = reference.range_m(track.ephemeris, start + at_s, place)
        spec = signal_spec(signal)
        phase = counterfeit.emitter.received_phase_cycles(np.array([at_s]))[0]
        assert -phase * C / spec.carrier_hz == pytest.approx(way_m - C * clock_s, abs=1e-4)
        chips = counterfeit.emitter.code_phase_chips(np.array([at_s]))[0]
        behind_s = at_s - chips / spec.chip_rate_hz - (track.reference - start)
        group_m = C * track.ephemeris.group_delay_s(signal)
        assert C * behind_s == pytest.approx(way_m - C * clock_s + group_m, abs=1e-4)


def test_it_begins_aligned_and_rises() -> None:
    at_s = np.array([0.4, 0.5, 0.75, 1.2, 3.9])
    d = difference(made(), 30, "B1I", at_s)
    assert d.code_m[:4] == pytest.approx(np.zeros(4), abs=1e-5)
    assert d.phase_cycles[:4] == pytest.approx(np.zeros(4), abs=1e-5)
    assert d.power_db == pytest.approx([-math.inf, -20.0, -7.0, 6.0, 6.0], abs=1e-4)
    assert abs(d.code_m[4]) > 20.0
    assert d.phase_cycles[4] == pytest.approx(-d.code_m[4] * 1561.098e6 / C, abs=1e-3)


def test_a_time_drag_is_the_same_for_all() -> None:
    scenario = made(velocity_enu_m_s=(0.0, 0.0, 0.0), clock_rate_ppb=100.0)
    at_s = np.array([3.5])
    for prn in (1, 30, 38):
        d = difference(scenario, prn, "B1I", at_s)
        assert d.code_m == pytest.approx([1.5 * 100e-9 * C], abs=1e-4)
    late = truth(scenario)["sky"]["counterfeit"][0]["clock_s"]
    assert late[35] == pytest.approx(150e-9, abs=1e-14)


def test_frequency_locked_counterfeits_keep_their_carrier() -> None:
    scenario, coherent = made(carrier="frequency-locked"), made()
    at_s = np.linspace(0.6, 3.9, 7)
    locked, moved = (difference(s, 30, "B1I", at_s) for s in (scenario, coherent))
    assert np.abs(locked.phase_cycles).max() < 1e-6
    # Straight between knots of 0.1 s: 50 m/s^2 (0.1 s)^2 / 8 while it grows.
    assert locked.code_m == pytest.approx(moved.code_m, abs=0.07)


def test_a_false_trajectory_and_some_satellites() -> None:
    false = PLACE | {"height_m": 530.0}
    change = {"trajectory": false, "drag_start_s": None, "velocity_enu_m_s": (0.0, 0.0, 0.0)}
    scenario = made(**change, prns=(30, 38))
    elevation = satellite(scenario, "C", 30).track.view.way.elevation_rad[30]
    d = difference(scenario, 30, "B1I", np.array([1.0]))
    assert d.code_m == pytest.approx([-500 * math.sin(elevation)], abs=0.01)
    assert not added(scenario, 40, "B1I")
    assert authentic(scenario, 40, "B1I").role == "authentic"


def test_the_receiver_is_led_away() -> None:
    scenario = builtin_scenario("sky-spoofed").sped_up(5)
    names = [s.prn for s in scenario.satellites if s.prn in (30, 38, 20)]
    log = simulate(scenario)
    for t in (t for t in log.signals if t.prn in names):
        at_s = np.asarray(t.time_s)[-20:]
        (false,) = added(scenario, t.prn, "B1I")
        late = false.emitter.code_phase_chips(at_s) - np.asarray(t.code_phase_chips)[-20:]
        metres = ((late + 1023) % 2046 - 1023) * C / 2.046e6
        assert abs(metres.mean()) < 8.0
        doppler = np.asarray(t.doppler_hz)[-20:] - false.emitter.doppler_hz(at_s)
        assert abs(doppler.mean()) < 2.0


def test_the_truth_tells_of_the_false_place() -> None:
    told = truth(made())
    entry = next(a for a in told["attacks"] if a["prn"] == 30)
    assert entry["role"] == "spoof"
    assert entry["capture_s"] == pytest.approx(0.5 + 0.5 * 20 / 26)
    assert entry["drag_full_s"] == 2.5
    place = np.array(told["sky"]["counterfeit"][0]["position_m"][35])
    moved = enu_matrix(31.2, 121.5) @ (place - ANTENNA)
    assert moved == pytest.approx([45.0, 60.0, 7.5], abs=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"drag_start_s": None}, "need drag_start_s"),
        ({"velocity_enu_m_s": (0.0, 0.0, 0.0)}, "needs velocity_enu_m_s or clock_rate_ppb"),
        ({"drag_start_s": 0.2}, "before start_s"),
        ({"drag_end_s": 2.0}, "before the drag is full"),
        ({"eta": 2.0}, "give one of them"),
        ({"trajectory": PLACE}, "give one of them"),
        ({"drag_start_s": 9.0}, "after the end of the recording"),
        ({"prns": (61,)}, "no .*satellite.* C61"),
    ],
)
def test_mistakes_are_told(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        made(**change)


def test_only_satellites_of_a_sky_can_be_seen_from_elsewhere() -> None:
    plain = {"recording": sky().recording.model_dump(), "satellite": [{"prn": 27}]}
    with pytest.raises(ValueError, match="use kind = 'induced'"):
        Scenario.model_validate(plain | {"attack": [ATTACK | {"prn": 27}]})
    with pytest.raises(ValueError, match="no satellite of the scenario is meant"):
        Scenario.model_validate(plain | {"attack": [ATTACK]})


def test_other_kinds_apply_to_a_sky() -> None:
    induced = {
        "prn": 30,
        "signals": ["B1I"],
        "start_s": 0.5,
        "carrier_phase_cycles": "antipodal",
        "drag_start_s": 2.6,
        "drag_rate_m_s": 8.0,
        "drag_ramp_s": 0.4,
    }
    more = {"cn0_horizon_dbhz": 38.0, "ionosphere": "klobuchar", "elevation_mask_deg": 40.0}
    at_s = np.array([2.5, 3.5])
    d = difference(sky(attack=induced, **more), 30, "B1I", at_s)
    assert d.code_m == pytest.approx([0.0, 0.2 * 8 + 0.5 * 8], abs=1e-5)
    assert d.power_db == pytest.approx([3.5, 3.5], abs=1e-9)
    turned = -d.code_m * 1561.098e6 / C
    assert d.phase_cycles == pytest.approx(0.5 + turned, abs=1e-5)
    meacon = {"kind": "meaconing", "start_s": 1.0, "delay_m": 150.0}
    scenario = sky(attack=meacon, elevation_mask_deg=60.0)
    for seen in (s for s in scenario.satellites if s.system == "C"):
        d = difference(scenario, seen.prn, "B1I", at_s)
        assert d.code_m == pytest.approx([150.0, 150.0], abs=1e-5)


def test_profiles_add_up() -> None:
    a: Knots = [(0.0, 1.0), (2.0, 3.0), (2.0, 10.0)]
    b: Knots = [(1.0, 0.0), (1.0, 5.0), (3.0, 7.0)]
    assert sum_of(a, b) == [
        (0.0, 1.0),
        (1.0, 2.0),
        (1.0, 7.0),
        (2.0, 9.0),
        (2.0, 16.0),
        (3.0, 17.0),
    ]
    assert sum_of(a, []) == a
    assert sum_of([], b) == b
