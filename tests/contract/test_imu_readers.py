"""Every registered reader of IMU files: reads what an IMU wrote, and refuses what is broken."""

import dataclasses
import sys
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof.aiding.imu.axes import checked
from sdr_spoof.aiding.imu.config import ImuConfig
from sdr_spoof.aiding.imu.readers import READERS, read_imu
from sdr_spoof.errors import InertialError

sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))
from imu_files import QUANTA, START, WRITERS, drive

NAMES = [r.name for r in READERS]


@pytest.fixture(scope="module")
def log():
    return drive()


def test_every_reader_has_a_file_to_read():
    assert set(WRITERS) == set(NAMES) == set(QUANTA)
    assert len(set(NAMES)) == len(NAMES)


@pytest.mark.parametrize("reader", READERS, ids=NAMES)
def test_it_describes_itself(reader):
    assert reader.title and checked(reader.axes) == reader.axes


@pytest.mark.parametrize("name", NAMES)
def test_it_finds_and_reads_its_files(name, log, tmp_path):
    got = read_imu(WRITERS[name](log, tmp_path / "imu.log"))
    assert got.format == name and not got.notes
    assert (got.log.reference - START) + got.log.time_s == pytest.approx(log.time_s, abs=1e-6)
    assert got.log.interval_s == pytest.approx(log.interval_s, abs=1e-6)
    rotation, velocity = QUANTA[name]
    assert got.log.rotation_rad == pytest.approx(log.rotation_rad, abs=rotation)
    assert got.log.velocity_m_s == pytest.approx(log.velocity_m_s, abs=velocity)


@pytest.mark.parametrize("name", NAMES)
def test_clock_and_axes_are_of_the_configuration(name, log, tmp_path):
    path = WRITERS[name](log, tmp_path / "imu.log")
    plain = read_imu(path, ImuConfig(format=name, checks=False)).log
    turned = {"csv": "FLU", "novatel": "LFD"}[name]
    config = ImuConfig(clock_offset_s=0.25, axes=turned, checks=False)
    got = read_imu(path, config).log
    assert got.time_s == pytest.approx(plain.time_s - 0.25)
    assert got.velocity_m_s == pytest.approx(plain.velocity_m_s * [1, -1, -1])


@pytest.mark.parametrize("name", NAMES)
def test_broken_files_are_refused(name, log, tmp_path):
    path = WRITERS[name](log, tmp_path / "imu.log")
    with pytest.raises(InertialError, match="cannot be read"):
        read_imu(tmp_path / "none.log", ImuConfig(format=name))
    for text in ("", "nothing of the kind\n1,2\n"):
        (tmp_path / "bad.log").write_text(text)
        with pytest.raises(InertialError, match=r"bad\.log"):
            read_imu(tmp_path / "bad.log", ImuConfig(format=name))
        with pytest.raises(InertialError, match="is no file of an IMU"):
            read_imu(tmp_path / "bad.log")
    backwards = path.read_text().splitlines()
    backwards[20], backwards[30] = backwards[30], backwards[20]
    (tmp_path / "back.log").write_text("\n".join(backwards))
    with pytest.raises(InertialError, match="sort the rows"):
        read_imu(tmp_path / "back.log")


@pytest.mark.parametrize("name", NAMES)
def test_upside_down_is_seen(name, log, tmp_path):
    flip = np.array([1.0, -1.0, -1.0])
    wrong = dataclasses.replace(
        log, rotation_rad=log.rotation_rad * flip, velocity_m_s=log.velocity_m_s * flip
    )
    with pytest.raises(InertialError, match=r"along the z axis.*points up.*FLU"):
        read_imu(WRITERS[name](wrong, tmp_path / "imu.log"))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", NAMES)
def test_damaged_files_are_read_or_refused(name, log, tmp_path):
    """Bytes changed, lines cut, doubled and lost: never anything but rows or one clear error."""
    short = dataclasses.replace(
        log,
        time_s=log.time_s[:80],
        rotation_rad=log.rotation_rad[:80],
        velocity_m_s=log.velocity_m_s[:80],
    )
    path = tmp_path / "imu.log"
    sound = WRITERS[name](short, path).read_bytes()
    rng = np.random.default_rng(5)
    for _ in range(100):
        data = bytearray(sound)
        for _ in range(rng.integers(1, 6)):
            at, length = int(rng.integers(len(data))), int(rng.integers(1, 40))
            cut = [b"", bytes(rng.integers(32, 127, length).astype(np.uint8)), b"\n,,nan,1e999,"]
            data[at : at + int(rng.integers(length))] = cut[int(rng.integers(3))]
        path.write_bytes(bytes(data))
        try:
            read = read_imu(path)
        except InertialError as error:
            assert "\n" not in str(error)
        else:
            assert np.isfinite(read.log.rotation_rad).all()
