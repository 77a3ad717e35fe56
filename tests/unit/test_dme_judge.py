"""Sequential tests on measurements, INS solutions and DME ranges; their files."""

import dataclasses

import numpy as np
import pytest

from sdr_spoof.aiding.dme.config import SequentialConfig
from sdr_spoof.aiding.dme.files import dme_text, ins_text, read_dme, read_ins
from sdr_spoof.aiding.dme.judge import judge
from sdr_spoof.aiding.dme.records import DmeLog
from sdr_spoof.aiding.dme.stations import Station, sigma_m, slant_ranges_m
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.aiding.simulated import (
    ClockWalk,
    ReceiverNoise,
    fixed,
    range_pull,
    simulate,
)
from sdr_spoof.errors import AidingError
from sdr_spoof.nav.geodesy import enu_matrix, geodetic_to_ecef
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.report import sequential_words as words
from sdr_spoof.report.sequential import sequential_page

PLACE = np.array([34.0, 108.0, 10_000.0])
SKY = ((20, 72), (70, 36), (150, 42), (230, 34), (310, 47), (100, 60), (275, 25))
STATIONS = (Station("NORTH", 34.6, 108.4, 400.0), Station("SOUTH", 33.6, 109.0, 500.0))
START = GnssTime.of_week(2300, 1000.0)
EPOCHS = 300
NOISE = ReceiverNoise(3.0, 0.0, 200.0, 0.002, 0.05)


def flight(speed_m_s=200.0):
    """Eastward at constant height, and what a perfect INS says of it."""
    time_s = np.arange(EPOCHS, dtype=float)
    axes = enu_matrix(*PLACE[:2])
    place = geodetic_to_ecef(PLACE) + np.outer(speed_m_s * time_s, axes[0])
    velocity = np.tile(speed_m_s * axes[0], (EPOCHS, 1))
    return time_s, place, velocity


def drive(attacks=(), seed=1, *, drift_m_s=(0.0, 0.0, 0.0), dme_seed=2):
    time_s, place, velocity = flight()
    constellation = fixed(time_s, place[0], SKY)
    clock = ClockWalk(offset_m=1000.0, drift_m_s=5.0)
    made = simulate(
        (place, velocity), constellation, time_s, NOISE, clock, attacks, seed, reference=START
    )
    off = np.outer(time_s, np.array(drift_m_s) @ enu_matrix(*PLACE[:2]))
    ins = InertialStates(
        START, time_s, place + off, velocity, np.zeros((EPOCHS, 3)), np.zeros(EPOCHS)
    )
    true = slant_ranges_m(STATIONS, place)
    noisy = true + sigma_m(true) * np.random.default_rng(dme_seed).standard_normal(true.shape)
    order = np.tile([0, 1], EPOCHS)
    dme = DmeLog(START, STATIONS, np.repeat(time_s, 2), order, noisy.ravel() + 30.0)
    return made.run(), ins, dme


def test_a_clean_flight_is_quiet():
    found = judge(*drive())
    assert found.alarm_s is None
    assert found.notes == ()
    assert {t.test for t in found.tested} == {
        "difference-clock-free",
        "parity-by-satellite",
        "dme-difference",
    }
    assert len(found.tested) == 15
    spread = np.array([t.series.value.std() for t in found.tested])
    assert np.all(np.abs(spread - 1.0) < 0.2)


@pytest.mark.parametrize("rule", ["glr-windows", "cusum", "improved-sprt", "sprt-classic"])
def test_a_pulled_satellite_is_found_and_named(rule):
    attack = range_pull((12.0, 0.0, 0.0), 150.0, satellites=("C03",))
    config = SequentialConfig(rule=rule)
    found = judge(*drive([attack]), config)
    assert 150.0 <= found.alarm_s < 190.0
    assert found.spoofed == ("C03",)
    assert not found.captured
    assert np.linalg.norm(found.isolation.after_m) < np.linalg.norm(found.isolation.before_m)


def test_a_captured_ins_is_seen_by_dme():
    measurements, ins, dme = drive()
    # GNSS and INS drift off together: 3 m/s to the north from 100 s on.
    _, place, velocity = flight()
    north = enu_matrix(*PLACE[:2])[1]
    moved = np.outer(3.0 * np.maximum(measurements.time_s - 100.0, 0.0), north)
    to = measurements.satellite_m - place[:, None]
    false = measurements.satellite_m - (place + moved)[:, None]
    change = np.linalg.norm(false, axis=-1) - np.linalg.norm(to, axis=-1)
    spoofed = dataclasses.replace(measurements, range_m=measurements.range_m + change)
    captured = dataclasses.replace(ins, position_m=place + moved, velocity_m_s=velocity)
    found = judge(spoofed, captured, dme)
    assert found.captured
    assert 100.0 < found.alarm_s < 220.0
    assert {t.test for t in found.tested if t.decided} == {"dme-difference"}
    assert judge(spoofed, captured).alarm_s is None
    said = list(words.sentences(found))
    assert said[0].startswith("All satellites alike, and the INS with them, since")
    assert "neither GNSS nor what it makes" in words.action(found)
    named = {"name": "x", "by": ("i",), "reference": START, "picture": b""}
    page = sequential_page(found, (), SequentialConfig(), **named)
    verdicts = {r.cells[1] for p in page.parts if p.table for r in p.table.rows}
    assert {"contradicts them", "contradicted by DME"} < verdicts


def test_a_clock_jump_is_no_attack():
    measurements, ins, dme = drive()
    jump = np.where(measurements.time_s > 120.0, 3e5, 0.0)[:, None]
    found = judge(dataclasses.replace(measurements, range_m=measurements.range_m + jump), ins, dme)
    assert found.alarm_s is None


def test_gaps_and_missing_numbers_are_skipped():
    measurements, ins, dme = drive()
    range_m = measurements.range_m.copy()
    range_m[60:90] = np.nan
    range_m[200:, 4] = np.nan
    kept = np.r_[0:140, 160:EPOCHS]
    ins = InertialStates(
        ins.reference, *(getattr(ins, f.name)[kept] for f in dataclasses.fields(ins)[1:])
    )
    found = judge(dataclasses.replace(measurements, range_m=range_m), ins, dme)
    assert found.alarm_s is None
    tested = {(t.test, t.channel): t.series.time_s for t in found.tested}
    first = tested["difference-clock-free", "C01"]
    assert first.size == EPOCHS - 30 - 19 or first.size == EPOCHS - 30 - 20
    assert not np.any((first > 140.5) & (first < 159.5))
    assert tested["difference-clock-free", "C05"].max() < 200.0


def test_too_few_satellites_are_said():
    measurements, ins, dme = drive()
    range_m = measurements.range_m.copy()
    range_m[:, 4:] = np.nan
    few = judge(dataclasses.replace(measurements, range_m=range_m), ins, dme)
    assert any("nothing is left to compare" in note for note in few.notes)
    assert {t.test for t in few.tested} == {"difference-clock-free", "dme-difference"}
    range_m[:, 1:] = np.nan
    with pytest.raises(AidingError, match="not two satellites"):
        judge(dataclasses.replace(measurements, range_m=range_m), ins, dme)
    with pytest.raises(AidingError, match="no time in common"):
        judge(measurements, dataclasses.replace(ins, time_s=ins.time_s + 1e5), dme)


def test_stations_in_line_are_said():
    measurements, ins, dme = drive()
    near = (STATIONS[0], dataclasses.replace(STATIONS[0], name="BESIDE", height_m=0.0))
    found = judge(measurements, ins, dataclasses.replace(dme, stations=near))
    assert any("in line" in note for note in found.notes)


def test_a_coloured_reference_is_refused():
    measurements, ins, dme = drive()
    waves = 40.0 * np.sin(2 * np.pi * measurements.time_s / 7.0)
    shaken = ins.position_m + np.outer(waves, enu_matrix(*PLACE[:2])[1])
    found = judge(measurements, dataclasses.replace(ins, position_m=shaken), dme)
    assert any("does not judge" in note for note in found.notes)
    assert "channels" in words.tested(found)


def test_files_come_back(tmp_path):
    _, ins, dme = drive()
    (tmp_path / "a.dme.csv").write_text(dme_text(dme))
    (tmp_path / "a.ins.csv").write_text(ins_text(ins))
    again, states = read_dme(tmp_path / "a.dme.csv"), read_ins(tmp_path / "a.ins.csv")
    assert again.stations == dme.stations
    np.testing.assert_array_equal(again.station, dme.station)
    np.testing.assert_allclose(again.range_m, dme.range_m, atol=1e-3)
    np.testing.assert_allclose(again.time_s, dme.time_s, atol=1e-6)
    assert again.reference == dme.reference == states.reference
    np.testing.assert_allclose(states.position_m, ins.position_m, atol=1e-3)
    np.testing.assert_allclose(states.velocity_m_s, ins.velocity_m_s, atol=1e-4)
    unknown = dataclasses.replace(dme, reference=None)
    (tmp_path / "b.csv").write_text(dme_text(unknown))
    assert read_dme(tmp_path / "b.csv").reference is None
    assert read_dme(tmp_path / "b.csv", START).reference == START


HEAD = "time_s,station,latitude_deg,longitude_deg,height_m,range_m\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no column station"),
        ("time_s,station\n1,A\n", "has no column latitude_deg"),
        (HEAD.replace("time_s", "time"), "gps_week and gps_tow_s, or time_s"),
        (HEAD, "has no rows"),
        (HEAD + "0,A,34,108,0,x\n", "is 'x', not a number"),
        (HEAD + "0,A,34,108\n", "too short"),
        (HEAD + "0,A,34,108,0,-5\n", "not above 0 m"),
        (HEAD + "0,A,34,108,0,9\n1,A,35,108,0,9\n", "two places"),
    ],
)
def test_bad_dme_files(tmp_path, text, message):
    path = tmp_path / "x.csv"
    path.write_text(text)
    with pytest.raises(AidingError, match=message):
        read_dme(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,latitude_deg,longitude_deg,height_m\n0,1,2,3\n0,1,2,3\n", "do not ascend"),
        ("time_s,latitude_deg,longitude_deg,height_m\n0,1,,3\n", "has no time or place"),
        ("time_s,latitude_deg\n0,1\n", "has no column longitude_deg"),
    ],
)
def test_bad_ins_files(tmp_path, text, message):
    path = tmp_path / "x.csv"
    path.write_text(text)
    with pytest.raises(AidingError, match=message):
        read_ins(path)
    with pytest.raises(AidingError, match="cannot be read"):
        read_ins(tmp_path / "missing.csv")


def test_missing_ranges_are_left_out(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text(HEAD + "1,A,34,108,0,9\n0,B,34,109,0,8\n2,A,34,108,0,\n")
    log = read_dme(path)
    assert log.time_s.tolist() == [0.0, 1.0]
    assert [log.stations[k].name for k in log.station] == ["B", "A"]
