"""What is wrong with IMU files, and what is said of it."""

import dataclasses

import numpy as np
import pytest
from imu_files import START, csv_of, drive, rates_csv, write_novatel, write_table
from pydantic import ValidationError

from sdr_spoof.aiding.imu.axes import into_body
from sdr_spoof.aiding.imu.config import ImuConfig
from sdr_spoof.aiding.imu.errors import ImuErrors, SensorErrors, read
from sdr_spoof.aiding.imu.grades import draw
from sdr_spoof.aiding.imu.readers import novatel, read_imu
from sdr_spoof.errors import InertialError

DEG = float(np.degrees(1.0))


@pytest.fixture(scope="module")
def ship():
    return drive("ship", 120.0)


@pytest.fixture(scope="module")
def car():
    return drive("vehicle", 300.0)


@pytest.fixture(scope="module")
def aircraft():
    return drive("uav", 300.0)


def turned(log, gyro=None, accel=None):
    """With matrices on gyros and on accelerometers."""
    eye = np.eye(3)
    return dataclasses.replace(
        log,
        rotation_rad=log.rotation_rad @ (eye if gyro is None else np.array(gyro)).T,
        velocity_m_s=log.velocity_m_s @ (eye if accel is None else np.array(accel)).T,
    )


@pytest.mark.parametrize("grade", ["navigation", "tactical", "industrial", "mems"])
@pytest.mark.parametrize("kind", ["ship", "car", "aircraft"])
def test_real_sensors_pass(kind, grade, request, tmp_path):
    log = read(request.getfixturevalue(kind), draw(grade, 3)[0]).log
    got = read_imu(write_table(log, tmp_path / "imu.csv"))
    assert all("too little motion" in note for note in got.notes)


def test_a_ship_tells_that_its_gyros_are_right(ship, tmp_path):
    assert read_imu(write_table(ship, tmp_path / "imu.csv")).notes == ()


@pytest.mark.parametrize(
    ("named", "size", "hint"),
    [
        ("m_s2", 1 / 9.80665, r"look like g: name the columns accel_x_g"),
        ("g", 1.0, r"look like m_s2: name the columns accel_x_m_s2"),
        ("m_s2", 1000 / 9.80665, "look like mg"),
        ("m_s2", 0.02, "look like m_s: "),
        ("m_s2", 0.02 / 9.80665, "look like g_s"),
    ],
)
def test_units_of_accelerometers(named, size, hint, ship, tmp_path):
    path = rates_csv(ship, tmp_path / "imu.csv", accel=named, of=(1.0, size))
    with pytest.raises(InertialError, match=hint):
        read_imu(path)


def test_accelerations_without_gravity(ship, tmp_path):
    level = dataclasses.replace(
        ship, velocity_m_s=ship.velocity_m_s + np.array([0, 0, 9.794 * 0.02])
    )
    with pytest.raises(InertialError, match="has gravity been taken off"):
        read_imu(write_table(level, tmp_path / "imu.csv"))


@pytest.mark.parametrize("kind", ["ship", "car"])
@pytest.mark.parametrize(
    ("named", "size", "hint"),
    [
        ("rad_s", DEG, r"look like deg_s: name the columns gyro_x_deg_s"),
        ("deg_s", 1.0, r"look like rad_s: name the columns gyro_x_rad_s"),
    ],
)
def test_units_of_gyros(named, size, hint, kind, request, tmp_path):
    log = request.getfixturevalue(kind)
    path = rates_csv(log, tmp_path / "imu.csv", gyro=named, of=(size, 1.0))
    with pytest.raises(InertialError, match=hint):
        read_imu(path)


def test_degrees_of_an_aircraft_that_banks(aircraft, tmp_path):
    path = rates_csv(aircraft, tmp_path / "imu.csv", of=(DEG, 1.0))
    with pytest.raises(InertialError, match=r"deg/s all the time; the values look like deg_s"):
        read_imu(path)
    assert read_imu(path, ImuConfig(checks=False)).log.interval_s == pytest.approx(0.02)


SWAP = [[0, 1, 0], [1, 0, 0], [0, 0, 1]]
BACK = np.diag([-1.0, -1.0, -1.0])


@pytest.mark.parametrize(
    ("gyro", "accel", "hint"),
    [
        (SWAP, None, "two axes of one of them are swapped"),
        (np.diag([1.0, -1.0, 1.0]), None, "or one is reversed"),
        (SWAP, SWAP, "left-handed"),
        (BACK, None, "the gyros turn the other way"),
        ([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], None, "their x and y axes differ"),
        (None, [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], r"along the x axis.*axes with D in place 1"),
        (None, [[1, 0, 0], [0, 0, -1], [0, 1, 0]], r"along the y axis.*axes with U in place 2"),
    ],
)
def test_axes(gyro, accel, hint, ship, tmp_path):
    with pytest.raises(InertialError, match=hint):
        read_imu(write_table(turned(ship, gyro, accel), tmp_path / "imu.csv"))


@pytest.mark.parametrize("axis", [0, 1])
def test_tilts_about_one_axis_tell_nothing(axis, ship, tmp_path):
    """And they must not be taken for a mistake."""
    time_s, size = ship.time_s, 0.1
    tilt, rate = size * np.sin(0.7 * time_s), size * 0.7 * np.cos(0.7 * time_s) * 0.02
    rotation, velocity = np.zeros((time_s.size, 3)), np.zeros((time_s.size, 3))
    rotation[:, axis] = rate
    velocity[:, 1 - axis] = (1, -1)[1 - axis] * 9.8 * np.sin(tilt) * 0.02
    velocity[:, 2] = -9.8 * np.cos(tilt) * 0.02
    log = dataclasses.replace(ship, rotation_rad=rotation, velocity_m_s=velocity)
    (note,) = read_imu(write_table(log, tmp_path / "imu.csv")).notes
    assert "too little motion" in note


def test_sensors_that_say_nothing(ship, tmp_path):
    still = dataclasses.replace(ship, rotation_rad=0 * ship.rotation_rad)
    (note,) = read_imu(write_table(still, tmp_path / "imu.csv")).notes
    assert "too little motion" in note
    dead = dataclasses.replace(ship, velocity_m_s=0 * ship.velocity_m_s)
    with pytest.raises(InertialError, match="has gravity been taken off"):
        read_imu(write_table(dead, tmp_path / "imu.csv"))


def test_letters_of_axes():
    assert into_body("RFU") @ [1.0, 2.0, 3.0] == pytest.approx([2.0, 1.0, -3.0])
    with pytest.raises(ValidationError, match="left-handed"):
        ImuConfig(axes="FRU")
    with pytest.raises(ValidationError, match="a letter each"):
        ImuConfig(axes="XYZ")


def test_numbers_that_are_none(ship, tmp_path):
    holes = ship.velocity_m_s.copy()
    holes[[10, 11], 1] = np.nan
    path = write_table(dataclasses.replace(ship, velocity_m_s=holes), tmp_path / "imu.csv")
    with pytest.raises(InertialError, match=r"2 of 6000 rows.*row 11 \(accelerometer y\)"):
        read_imu(path)
    path.write_text(path.read_text().replace("2253,43218.04", "2253,x"))
    with pytest.raises(InertialError, match=r"row 2 is not all numbers"):
        read_imu(path)


def test_times(ship, tmp_path):
    path = tmp_path / "imu.csv"
    lines = write_table(ship, path).read_text().splitlines()
    path.write_text("\n".join([*lines[:50], lines[49], *lines[50:]]))
    with pytest.raises(InertialError, match=r"row 50.*time of the row before"):
        read_imu(path)
    late = dataclasses.replace(ship, time_s=ship.time_s - np.where(ship.time_s > 60, 30.0, 0.0))
    with pytest.raises(InertialError, match=r"is 29\.98 s before.*clock was set back"):
        read_imu(write_table(late, path))
    time_s = ship.time_s % 60.0 + 604_740.0
    rolled = dataclasses.replace(
        ship, reference=None, time_s=np.where(ship.time_s < 60, time_s, ship.time_s - 60)
    )
    with pytest.raises(InertialError, match=r"is a week before.*gps_week"):
        read_imu(write_table(rolled, path))


def test_over_the_end_of_a_week(ship, tmp_path):
    late = dataclasses.replace(ship, reference=START + (604_800 - 43_218 - 60.0))
    got = read_imu(write_table(late, tmp_path / "imu.csv")).log
    assert (got.reference - late.reference) + got.time_s == pytest.approx(ship.time_s, abs=1e-6)


def test_gaps_are_told(ship, tmp_path):
    keep = (ship.time_s < 30) | (ship.time_s > 30.5)
    cut = dataclasses.replace(
        ship,
        time_s=ship.time_s[keep],
        rotation_rad=ship.rotation_rad[keep],
        velocity_m_s=ship.velocity_m_s[keep],
    )
    (note,) = read_imu(write_table(cut, tmp_path / "imu.csv")).notes
    assert "a gap of 0.5" in note and "a new alignment is needed" in note


def test_the_end_of_a_range(ship, tmp_path):
    rough = ship.velocity_m_s.copy()
    rough[200:203, 0] = 0.3
    path = write_table(dataclasses.replace(ship, velocity_m_s=rough), tmp_path / "imu.csv")
    got = read_imu(path)
    assert "accelerometer x is at the end of its range in 3 rows, first at" in got.notes[0]
    assert got.log.time_s.size == ship.time_s.size - 3
    rough[200:220, 0] = 0.3
    path = write_table(dataclasses.replace(ship, velocity_m_s=rough), tmp_path / "imu.csv")
    with pytest.raises(InertialError, match=r"end of its range for 0.40 s.*align anew"):
        read_imu(path)


def test_a_sensor_model_with_a_range_is_seen_to_be_at_its_end(aircraft, tmp_path):
    errors = ImuErrors(gyro=SensorErrors(limit=np.radians(8.0)))
    path = write_table(read(aircraft, errors).log, tmp_path / "imu.csv")
    with pytest.raises(InertialError, match=r"gyro x is at the end of its range for"):
        read_imu(path)


def test_rates_become_increments(ship, tmp_path):
    """Samples of a smooth rate, against the integrals of it."""
    time_s = ship.time_s
    w, w1 = 0.05 * np.sin(0.9 * time_s), -0.05 / 0.9 * np.cos(0.9 * time_s)
    columns = {f"gyro_{a}_deg_s": w * DEG for a in "xyz"}
    columns |= {"accel_x_g": 0 * w, "accel_y_g": 0 * w, "accel_z_g": 0 * w - 1.0}
    path = csv_of(ship, tmp_path / "imu.csv", **columns)
    got = read_imu(path, ImuConfig(checks=False)).log
    assert got.rotation_rad[2:-1, 0] == pytest.approx(np.diff(w1)[1:-1], abs=3e-12)
    assert got.velocity_m_s[:, 2] == pytest.approx(np.full(time_s.size, -9.80665 * 0.02))
    assert got.reference is None


def test_starts_of_the_time(ship, tmp_path):
    path = rates_csv(ship, tmp_path / "imu.csv")
    for start in ("2023-03-12T12:00:00", "GPS 2253 43218", "BDT 897 43204"):
        assert read_imu(path, ImuConfig(start=start)).log.reference == START
    with pytest.raises(InertialError, match="neither a date"):
        read_imu(path, ImuConfig(start="noon"))
    text = path.read_text().splitlines()
    rows = [
        f"{1678622400 + float(r.partition(',')[0]):.6f},{r.partition(',')[2]}" for r in text[1:]
    ]
    path.write_text("\n".join([text[0].replace("time_s", "unix_s"), *rows]))
    got = read_imu(path).log
    assert (got.reference - START) + got.time_s == pytest.approx(ship.time_s, abs=1e-5)


def test_times_that_are_no_seconds(ship, tmp_path):
    path = tmp_path / "imu.csv"
    for size, hint in ((1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")):
        rates_csv(dataclasses.replace(ship, time_s=ship.time_s * size), path)
        with pytest.raises(InertialError, match=f"apart.*{hint}"):
            read_imu(path)
    path.write_text(path.read_text().replace("time_s", "unix_s").replace("\n2", "\n16786224000002"))
    with pytest.raises(InertialError, match="is no date: are the times milliseconds"):
        read_imu(path)
    rates_csv(dataclasses.replace(ship, time_s=ship.time_s * 50), path)
    with pytest.raises(InertialError, match=r"rows are 1 s apart.*all rows"):
        read_imu(path)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("time_s,gyro_x_rad_s,gyro_y_rad_s", "needs columns gyro_x_UNIT"),
        ("time_s,gyro_x_rpm,gyro_y_rpm,gyro_z_rpm", "unknown unit 'rpm'; known: rad_s, deg_s"),
        ("time_s,gyro_x_rad,gyro_y_deg,gyro_z_rad", "differ in their unit"),
        (
            "time_s,gyro_x_rad,gyro_y_rad,gyro_z_rad,accel_x_g,accel_y_g,accel_z_g",
            "both as rates or both as increments",
        ),
        (
            "t,gyro_x_rad,gyro_y_rad,gyro_z_rad,accel_x_m_s,accel_y_m_s,accel_z_m_s",
            "has no time: name a column time_s",
        ),
        (
            "time_s,gyro_x_rad,gyro_y_rad,gyro_z_rad,accel_x_m_s,accel_y_m_s,accel_z_m_s",
            "has no rows",
        ),
    ],
)
def test_columns(header, message, tmp_path):
    path = tmp_path / "imu.csv"
    path.write_text(header + "\n")
    with pytest.raises(InertialError, match=message):
        read_imu(path)


def test_too_few_rows(ship, tmp_path):
    path = write_table(ship, tmp_path / "imu.csv")
    path.write_text("\n".join(path.read_text().splitlines()[:4]))
    with pytest.raises(InertialError, match="holds 3 rows of an IMU"):
        read_imu(path)


def test_checksums_of_novatel():
    """The example of a log in the OEM7 manual, section RAWIMUS."""
    body = (
        "RAWIMUSA,2209,491612.254;2209,491612.253588,ea5afe00,329303960,-2512321,4410363,309705,"
        "607017,-1009773"
    )
    assert novatel.crc32(body.encode()) == 0x1FB76C28


def test_novatel_logs_that_do_not_say_which_imu(ship, tmp_path):
    path = write_novatel(ship, tmp_path / "imu.log")
    lines = []
    for line in path.read_text().splitlines()[1:]:
        body = line[1:].partition("*")[0].replace("RAWIMUSXA", "RAWIMUSA").replace(";00,32,", ";")
        lines.append(f"%{body}*{novatel.crc32(body.encode()):08x}")
    path.write_text("\n".join(lines))
    with pytest.raises(InertialError, match="give model: LN200, HG1700"):
        read_imu(path)
    with pytest.raises(InertialError, match="unknown IMU 'best'"):
        read_imu(path, ImuConfig(model="best"))
    assert read_imu(path, ImuConfig(model="stim300")).log.time_s.size == 6000
    with pytest.raises(InertialError, match="are the scale factors those of this IMU"):
        read_imu(path, ImuConfig(model="ADIS16488"))
    path.write_text("\n".join(line.replace(",", ",1", 1) for line in lines))
    with pytest.raises(InertialError, match="the checksums of all 6000 are wrong"):
        read_imu(path)


def test_novatel_rates_are_rates(tmp_path):
    """The IMU of the manual's example of RAWIMUSX, type 41, gives rates: 9.85 m/s^2 upwards."""
    lines = []
    for k in range(10):
        body = (
            f"RAWIMUSXA,2209,491674.014;04,41,2209,{491674.013699 + k / 125:.6f},ea59fe00,"
            "329308016,-2706935,4508389,196192,417138,-1000837"
        )
        lines.append(f"%{body}*{novatel.crc32(body.encode()):08x}")
    path = tmp_path / "imu.log"
    path.write_text("\n".join(lines))
    got = read_imu(path).log
    assert got.velocity_m_s[:, 2] * 125 == pytest.approx(np.full(10, -9.8555), abs=1e-3)
