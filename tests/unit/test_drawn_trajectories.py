"""Vehicles, aircraft and ships that move by chance."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from sdr_spoof.nav.geodesy import ecef_to_geodetic, geodetic_to_ecef
from sdr_spoof.scenario.sky import earth
from sdr_spoof.scenario.sky.manoeuvres import Leg, way
from sdr_spoof.scenario.sky.receiver import AnyReceiver
from sdr_spoof.scenario.sky.trajectory import OnPlane, Trajectory, along
from sdr_spoof.scenario.sky.waves import SEAS, Hull, Sea, bretschneider, oscillator

PLACE = {"latitude_deg": 31.2, "longitude_deg": 121.5, "height_m": 20.0}
TIMES = np.arange(0.0, 600.0, 0.1)


def made(kind: str, duration_s: float = 600.0, **keys: object) -> Trajectory:
    table = {"kind": kind, **(PLACE if kind != "uav" else {}), **keys}
    return TypeAdapter(AnyReceiver).validate_python(table).trajectory(duration_s)


def level_velocity(t: Trajectory, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """East, north, up."""
    assert isinstance(t.body, OnPlane)
    return t.body.velocity_enu_m_s(time_s)


def across_m_s2(t: Trajectory, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    speed = np.hypot(*level_velocity(t, time_s)[:, :2].T)
    yaw = t.attitude_rad(time_s)[:, 0]
    return np.asarray(speed * np.gradient(yaw, time_s))


@pytest.mark.parametrize("kind", ["vehicle", "uav", "ship"])
def test_a_seed_is_a_way(kind: str) -> None:
    one, same, other = (made(kind, seed=s).position_m(TIMES) for s in (4, 4, 5))
    np.testing.assert_array_equal(one, same)
    assert np.linalg.norm(one - other, axis=1).max() > 100.0


@pytest.mark.parametrize("kind", ["vehicle", "uav", "ship"])
def test_velocity_and_position_agree(kind: str) -> None:
    t = made(kind, seed=1)
    at_s = np.arange(1.0, 599.0, 0.37)
    change = t.body(at_s + 0.01) - t.body(at_s - 0.01)
    # The central difference is off by the jerk, up to 8 m/s^3, times 2e-5 s^2.
    assert t.body_velocity_m_s(at_s) == pytest.approx(change / 0.02, abs=2e-4)


def test_a_car_starts_stops_and_turns() -> None:
    t = made("vehicle", seed=2)
    speed = np.hypot(*level_velocity(t, TIMES)[:, :2].T)
    assert speed[:80].max() < 1e-6
    assert speed.max() > 8.0
    stands = speed < 1e-3
    assert (np.diff(stands.astype(int)) == 1).sum() >= 1
    across = np.abs(across_m_s2(t, TIMES))
    assert 1.5 < across.max() < 3.1
    # The nose points along the way.
    east, north, _ = level_velocity(t, TIMES).T
    moves = speed > 0.5
    slip = np.arctan2(east, north) - t.attitude_rad(TIMES)[:, 0]
    assert np.abs(np.angle(np.exp(1j * slip)))[moves].max() < 2e-3


def test_a_car_does_not_turn_where_it_stands() -> None:
    t = made("vehicle", seed=2)
    speed = np.hypot(*level_velocity(t, TIMES)[:, :2].T)
    turns = np.abs(np.gradient(t.attitude_rad(TIMES)[:, 0], TIMES))
    assert turns[speed < 1e-4].max() < 1e-4


def test_the_aircraft_of_the_study() -> None:
    t = made("uav", 1750.0)
    start = ecef_to_geodetic(t.body(np.zeros(1)))[0]
    assert start == pytest.approx([34.0, 108.0, 400.0], abs=1e-6)
    early = level_velocity(t, np.arange(0.0, 55.0))
    assert early[:, 0] == pytest.approx(np.full(55, 40.0), abs=1e-3)
    assert np.abs(early[:, 1:]).max() < 1e-3
    across = np.abs(across_m_s2(t, np.arange(0.0, 1750.0, 0.1)))
    assert 2.0 < across.max() < 3.9


def test_an_aircraft_banks_into_its_turns() -> None:
    t = made("uav", 600.0, seed=3)
    roll = t.attitude_rad(TIMES)[:, 2]
    expected = np.arctan(across_m_s2(t, TIMES) / 9.80665)
    assert roll == pytest.approx(expected, abs=0.01)


def test_a_hover_and_one_that_cannot_be() -> None:
    t = made("uav", 100.0, hover_s=(25.0, 50.0))
    at_s = np.arange(26.0, 49.0, 0.5)
    assert np.abs(level_velocity(t, at_s)).max() < 1e-4
    assert np.hypot(*level_velocity(t, np.array([70.0]))[0, :2]) > 30.0
    with pytest.raises(ValidationError, match=r"hover_s: .* begin at 14.3 s or later"):
        made("uav", hover_s=(5.0, 50.0))


def test_a_ship_keeps_its_speed_and_its_sea() -> None:
    t = made("ship", 3000.0, seed=1, sea_state=4)
    at_s = np.arange(0.0, 3000.0, 0.5)
    velocity = level_velocity(t, at_s)
    assert np.hypot(*velocity[:, :2].T) == pytest.approx(np.full(at_s.size, 8.0), abs=0.02)
    assert isinstance(t.body, OnPlane)
    heave = t.body.enu_m(at_s)[:, 2]
    assert 0.1 < heave.std() < SEAS[4][0] / 4
    attitude = np.degrees(t.attitude_rad(at_s))
    assert 0.1 < attitude[:, 1].std() < 5.0
    assert 0.1 < attitude[:, 2].std() < 8.0
    assert np.abs(across_m_s2(t, at_s)).max() < 8.0 * math.radians(1.1)


def test_a_calm_sea_is_flat() -> None:
    t = made("ship", sea_state=0)
    assert isinstance(t.body, OnPlane)
    assert np.abs(t.body.enu_m(TIMES)[:, 2]).max() == 0.0
    assert np.abs(t.attitude_rad(TIMES)[:, 1:]).max() == 0.0


def test_the_spectrum_holds_the_wave_height() -> None:
    height, period = SEAS[4]
    rate = np.linspace(0.05, 20.0, 40_000)
    energy = np.trapezoid(bretschneider(height, period, rate), rate)
    assert 4 * math.sqrt(energy) == pytest.approx(height, rel=1e-3)
    sea = Sea.drawn(4, 0.0, np.random.default_rng(1))
    assert 4 * math.sqrt((sea.amplitude_m**2).sum() / 2) == pytest.approx(height, rel=0.15)


def test_a_ship_lies_on_long_waves_as_a_raft() -> None:
    """Waves far longer and slower than it: heave is the surface, roll and pitch its slope."""
    rate = np.array([0.05])
    sea = Sea(rate, np.array([2.0]), np.array([0.4]), towards_rad=0.0)
    number = float(rate[0] ** 2 / 9.80665)
    hull = Hull(heave_damping=0.0, roll_damping=0.0, pitch_damping=0.0)
    for heading in (0.0, math.pi / 2, 2.0):
        ship = way([Leg(1.0)], 400.0, speed_m_s=0.4, heading_rad=heading)
        heave, pitch, roll = sea.moves(ship, hull)
        angle = number * ship.north_m - 0.05 * ship.time_s + 0.4
        slope_north = -2.0 * number * np.sin(angle)
        assert heave == pytest.approx(2.0 * np.cos(angle), abs=0.05)
        assert pitch == pytest.approx(slope_north * math.cos(heading), abs=1.5e-5)
        # Roll is positive to starboard down; heading east, port is north.
        assert roll == pytest.approx(slope_north * math.sin(heading), abs=1.5e-5)


def test_oscillators_follow_slow_waves_and_lag_at_resonance() -> None:
    assert oscillator(np.array([1e-3]), 10.0, 0.1)[0] == pytest.approx(1.0, abs=1e-3)
    at_resonance = oscillator(np.array([math.tau / 10.0]), 10.0, 0.1)[0]
    assert abs(at_resonance) == pytest.approx(5.0)
    # The phase of waves falls with time: a lag is a phase that is ahead.
    assert np.angle(at_resonance) == pytest.approx(math.pi / 2)


def test_manoeuvres_come_and_go_softly() -> None:
    legs = [Leg(5.0), Leg(10.0, speed_m_s=-20.0), Leg(5.0), Leg(10.0, speed_m_s=10.0)]
    got = way(legs, 40.0, speed_m_s=20.0, heading_rad=0.0)
    at = np.interp([4.0, 10.0, 17.5, 25.0, 39.0], got.time_s, got.speed_m_s)
    assert at == pytest.approx([20.0, 10.0, 0.0, 5.0, 10.0], abs=1e-9)
    assert np.abs(np.diff(got.speed_m_s, 2)).max() / 0.1**2 < 2.0 / 0.4
    assert np.interp(40.0, got.time_s, got.length_m) == pytest.approx(100 + 100 + 50 + 100)


def test_where_it_stands_it_looks_as_it_came() -> None:
    def enu_m(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        gone = np.clip(time_s, 0.0, 5.0) + np.clip(time_s - 10.0, 0.0, None)
        return np.stack([gone, 0 * gone, 0 * gone], axis=-1)

    looks = along(enu_m, np.arange(-2.0, 12.0, 0.02))
    assert looks(np.array([-1.0, 2.0, 7.0, 11.0]))[:, 0] == pytest.approx(np.full(4, np.pi / 2))
    assert not along(lambda t: np.zeros((t.size, 3)), TIMES)(TIMES).any()


def test_true_metres_a_metre_of_the_plane() -> None:
    origin = np.array([34.0, 108.0, 400.0])
    places = earth.from_plane(origin, np.array([[0.0, 50e3, 100.0]]))
    stretch = earth.stretch(origin, places)[0]
    step = np.eye(3)
    for axis in range(3):
        ends = np.array([[0.0, 50e3, 100.0]]) + np.stack([-step[axis], step[axis]])
        a, b = geodetic_to_ecef(earth.from_plane(origin, ends))
        assert np.linalg.norm(b - a) / 2 == pytest.approx(stretch[axis], rel=1e-7)
