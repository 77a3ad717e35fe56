"""Trajectories of the receiver, from tables and files."""

import math
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter
from skies import CIRCLE, PLACE

from sdr_spoof.errors import ConfigError
from sdr_spoof.nav.geodesy import ecef_to_geodetic, enu, geodetic_to_ecef
from sdr_spoof.scenario.sky.receiver import AnyReceiver
from sdr_spoof.scenario.sky.trajectory import Trajectory, rotations
from sdr_spoof.scenario.sky.trajectory_files import read_csv, read_nmea

ORIGIN = geodetic_to_ecef([31.2, 121.5, 30.0])
G = 9.80665


def made(duration_s: float = 60.0, **table: object) -> Trajectory:
    receiver = TypeAdapter(AnyReceiver).validate_python(table)
    return receiver.trajectory(duration_s)


def acceleration(t: Trajectory, at_s: np.ndarray, step_s: float = 0.05) -> np.ndarray:
    places = [enu(t.position_m(at_s + k * step_s), ORIGIN) for k in (-1, 0, 1)]
    return np.asarray((places[0] - 2 * places[1] + places[2]) / step_s**2)


def test_one_that_stands_still() -> None:
    t = made(**PLACE)
    at_s = np.array([0.0, 9.0])
    assert t.position_m(at_s) == pytest.approx(np.stack([ORIGIN, ORIGIN]), abs=1e-8)
    assert np.abs(t.velocity_m_s(at_s)).max() == 0.0


def test_a_circle_has_its_speed_and_acceleration() -> None:
    t = made(**CIRCLE)
    at_s = np.linspace(0.0, 30.0, 61)
    speed = np.linalg.norm(t.velocity_m_s(at_s), axis=1)
    # The plane map is true to the ellipsoid within 1e-5 at 92 m.
    assert speed == pytest.approx(np.full(61, 30.0), rel=3e-5)
    force = np.linalg.norm(acceleration(t, at_s), axis=1)
    assert force == pytest.approx(np.full(61, 900 / 91.8), rel=1e-3)
    yaw = np.degrees(t.attitude_rad(np.array([0.0]))[0, 0])
    assert yaw == pytest.approx(90.0, abs=0.01)  # north of the middle, clockwise: to the east


def test_a_way_through_waypoints() -> None:
    corners = [(0.0, 0.0, 10.0), (0.0, 400.0, 30.0), (300.0, 400.0, 30.0), (300.0, 700.0, 30.0)]
    points = [{"east_m": e, "north_m": n, "speed_m_s": v} for e, n, v in corners]
    t = made(45.0, **(PLACE | {"kind": "waypoints", "waypoint": points, "turn_g": 1.0}))
    at_s = np.linspace(0.0, 45.0, 901)
    place = enu(t.position_m(at_s), ORIGIN)
    assert place[0, :2] == pytest.approx([0.0, 0.0], abs=1.2)
    velocity = np.linalg.norm(t.velocity_m_s(at_s), axis=1)
    assert velocity[20] == pytest.approx(10.0 + 20.0 / 15.4, abs=0.3)
    # 400 m less the turn's 91.8 m from 10 to 30 m/s: 15.4 s; then constant but for the smoothing.
    assert velocity[400:] == pytest.approx(np.full(501, 30.0), abs=0.6)
    force = np.linalg.norm(acceleration(t, at_s)[:, :2], axis=1)
    assert force.max() == pytest.approx(G, rel=0.02)
    # Two quarter turns of 91.8 m at 30 m/s take 4.8 s each; they begin and end in half a second.
    assert (force > 0.9 * G).sum() * 0.05 == pytest.approx(2 * (4.8 - 0.45), abs=0.6)
    # No steps: 1 g comes within 1 s.
    jerk = np.abs(np.diff(acceleration(t, at_s), axis=0)).max() / 0.05
    assert jerk < 2.1 * G
    # After the last point straight on.
    assert place[-1, 0] == pytest.approx(300.0, abs=0.5)


def test_waypoints_by_latitude_and_longitude() -> None:
    there = ecef_to_geodetic(geodetic_to_ecef([31.201, 121.502, 30.0]))
    points = [
        {"latitude_deg": 31.2, "longitude_deg": 121.5, "speed_m_s": 10.0},
        {"latitude_deg": there[0], "longitude_deg": there[1], "speed_m_s": 10.0},
    ]
    t = made(30.0, **(PLACE | {"kind": "waypoints", "waypoint": points}))
    end = ecef_to_geodetic(geodetic_to_ecef([31.201, 121.502, 30.0]))
    way = float(np.linalg.norm(geodetic_to_ecef(end) - ORIGIN))
    found = t.position_m(np.array([way / 10.0]))[0]
    assert found == pytest.approx(geodetic_to_ecef([31.201, 121.502, 30.0]), abs=0.05)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([(0.0, 0.0, 30.0), (0.0, 50.0, 30.0), (50.0, 50.0, 30.0)], "move the points apart"),
        ([(0.0, 0.0, 1.0), (0.0, 0.0, 1.0)], "same place"),
        ([(0.0, 0.0, 0.0), (0.0, 9.0, 0.0)], "speed_m_s is 0"),
    ],
)
def test_ways_that_cannot_be_driven(points: list[tuple[float, float, float]], message: str) -> None:
    table = [{"east_m": e, "north_m": n, "speed_m_s": v} for e, n, v in points]
    with pytest.raises(ValueError, match=message):
        made(5.0, **(PLACE | {"kind": "waypoints", "waypoint": table}))
    with pytest.raises(ValueError, match="give east_m and north_m"):
        made(
            5.0, **(PLACE | {"kind": "waypoints", "waypoint": [{"east_m": 1, "speed_m_s": 1}] * 2})
        )


def test_yaw_pitch_and_roll_turn_the_antenna() -> None:
    quarter = math.pi / 2
    attitudes = np.array([[0, 0, 0], [quarter, 0, 0], [0, quarter, 0], [0, 0, quarter]], float)
    turned = rotations(attitudes) @ np.eye(3)
    # Columns: where forward, right and down point, in north, east, down.
    assert turned[0] == pytest.approx(np.eye(3))
    assert turned[1][:, 0] == pytest.approx([0, 1, 0], abs=1e-15)
    assert turned[2][:, 0] == pytest.approx([0, 0, -1], abs=1e-15)
    assert turned[3][:, 1] == pytest.approx([0, 0, 1], abs=1e-15)


def test_a_file_with_attitude_and_a_lever_arm(tmp_path: Path) -> None:
    path = tmp_path / "way.csv"
    rows = [f"{k},31.2,121.5,30.0,{(10 * k) % 360},0,0" for k in range(60)]
    header = "time_s,latitude_deg,longitude_deg,height_m,yaw_deg,pitch_deg,roll_deg"
    path.write_text("\n".join([header, *rows]))
    t = made(50.0, kind="csv", file=str(path), lever_arm_m=(2.0, 0.0, -1.0))
    at_s = np.array([0.0, 9.0, 40.5])
    assert np.degrees(t.attitude_rad(at_s))[:, 0] == pytest.approx([0, 90, 405], abs=1e-6)
    bearing = np.radians([0.0, 90.0, 45.0])
    expected = np.stack([2 * np.sin(bearing), 2 * np.cos(bearing), np.ones(3)], axis=-1)
    assert enu(t.position_m(at_s), ORIGIN) == pytest.approx(expected, abs=1e-6)
    # The antenna goes round the body at 10 degrees a second.
    speed = np.linalg.norm(t.velocity_m_s(at_s), axis=1)
    assert speed == pytest.approx(np.full(3, 2 * math.radians(10)), abs=1e-5)
    with pytest.raises(ValueError, match=r"goes from 0 to 59 s.*shorten duration_s"):
        made(70.0, kind="csv", file=str(path))


def test_earth_fixed_columns(tmp_path: Path) -> None:
    path = tmp_path / "way.csv"
    x, y, z = ORIGIN
    path.write_text("z_m,time_s,x_m,y_m\n" + "".join(f"{z},{k},{x + k},{y}\n" for k in range(6)))
    t = made(5.0, kind="csv", file=str(path))
    assert t.position_m(np.array([2.5]))[0] == pytest.approx(
        ORIGIN + np.array([2.5, 0, 0]), abs=1e-6
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("time_s,x_m\n0,1\n", "needs the columns"),
        ("time_s,x_m,y_m,z_m\n" + "0,1,2\n", "row 2 does not hold"),
        ("time_s,x_m,y_m,z_m\n" + "0,1,2,3\n1,1,2,nan\n", "not finite"),
        ("time_s,x_m,y_m,z_m\n" + "0,1,2,3\n" * 4, "times must increase"),
        ("time_s,x_m,y_m,z_m\n0,1,2,3\n", "needs 4 or more"),
    ],
)
def test_files_that_are_wrong(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "way.csv"
    path.write_text(text)
    with pytest.raises(ConfigError, match=message):
        read_csv(path)
    with pytest.raises(ConfigError, match="cannot be read"):
        read_csv(tmp_path / "none.csv")


def _gga(clock: str, latitude: str, fix: str = "1") -> str:
    body = f"GNGGA,{clock},{latitude},N,12130.0000,W,{fix},12,0.8,25.0,M,5.0,M,,"
    total = 0
    for byte in body.encode():
        total ^= byte
    return f"${body}*{total:02X}"


def test_nmea(tmp_path: Path) -> None:
    good = [_gga(f"2359{58 + k:02d}.00", f"311{2 + k}.0000") for k in range(2)]
    good += [_gga(f"00000{k}.50", f"311{4 + k}.0000") for k in range(3)]
    lines = [
        good[0],
        "$GPRMC,x*00",
        _gga("235958.50", "3199.0", "0"),
        *good[1:],
        good[2][:-1] + "?",
    ]
    path = tmp_path / "log.nmea"
    path.write_text("\r\n".join(lines))
    track = read_nmea(path)
    assert track.time_s == pytest.approx([0.0, 1.0, 2.5, 3.5, 4.5])
    place = ecef_to_geodetic(track.position_m)
    assert place[:, 0] == pytest.approx([31 + m / 60 for m in (12, 13, 14, 15, 16)], abs=1e-9)
    assert place[:, 1] == pytest.approx(np.full(5, -121.5), abs=1e-9)
    assert place[:, 2] == pytest.approx(np.full(5, 30.0), abs=1e-6)
