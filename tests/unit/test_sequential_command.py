"""``sdr-spoof sequential`` on files in closed form; DME stations of scenarios."""

import dataclasses
import json

import numpy as np
import observed_sky as sky
import pytest
from pydantic import ValidationError
from skies import PLACE, RECORDING, VACUUM

from sdr_spoof.aiding.dme.files import dme_text, ins_text, read_dme
from sdr_spoof.aiding.dme.records import DmeLog
from sdr_spoof.aiding.dme.stations import Station, sigma_m, slant_ranges_m
from sdr_spoof.aiding.records import InertialStates
from sdr_spoof.cli import main
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.scenario import Scenario, dme_of, dme_path, synthesize

LENGTH_S = 200
TIME = np.arange(float(LENGTH_S))
NAV = sky.VECTORS / "brd4_2023071_04h_08h.rnx"
STATIONS = (Station("NORTH", 40.5, 116.5, 50.0), Station("EAST", 39.9, 117.3, 20.0))
AS_IN_CLOSED_FORM = ("--pvt-ionosphere", "none", "--pvt-troposphere", "none")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flight")
    made = sky.Sky(epochs=LENGTH_S, sigma_m=2.0, satellites=8).observe()
    ranges = made.pseudorange_m.copy()
    ranges[120:, 3] += 12.0
    from sdr_spoof.sinks.rinex_obs import write_rinex_obs  # noqa: PLC0415

    write_rinex_obs(folder / "x.rnx", dataclasses.replace(made, pseudorange_m=ranges))
    write_rinex_obs(folder / "clean.rnx", made)
    place = np.tile(sky.PLACE, (LENGTH_S, 1))
    nothing = np.zeros((LENGTH_S, 3))
    ins = InertialStates(sky.START, TIME, place, nothing, nothing, nothing[:, 0])
    (folder / "ins.csv").write_text(ins_text(ins))
    true = slant_ranges_m(STATIONS, place)
    noisy = true + sigma_m(true) * np.random.default_rng(2).standard_normal(true.shape)
    order = np.tile([0, 1], LENGTH_S)
    log = DmeLog(sky.START, STATIONS, np.repeat(TIME, 2), order, noisy.ravel())
    (folder / "dme.csv").write_text(dme_text(log))
    return folder, made.satellites[3]


def sequential(files, *more, observations="x.rnx"):
    folder = files[0]
    words = ["sequential", str(folder / observations), "--ins", str(folder / "ins.csv")]
    words += ["--nav", str(NAV), *AS_IN_CLOSED_FORM]
    return main([*words, *map(str, more)])


def test_the_satellite_is_named(files, tmp_path, capsys):
    folder, name = files
    out = tmp_path / "out"
    assert sequential(files, "--dme", folder / "dme.csv", "-o", out, "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert data["verdict"] == "spoofed"
    assert data["satellites"] == [name]
    assert 118 < data["alarm_s"] < 150
    assert not data["ins_captured"]
    assert data["tested"] == 17
    assert np.linalg.norm(data["fix_off_without_m"]) < np.linalg.norm(data["fix_off_m"])
    report = (out / "report.html").read_text(encoding="utf-8")
    assert report.count("data:image/png") == 2
    for expected in ("Spoofing detected", f"{name}, since", "drawn by the others", "DME 1 - 2"):
        assert expected in report
    for expected in ("against ins.csv and dme.csv", "sequential.rule", "false trajectory"):
        assert expected in report
    assert (out / "sequential.png").read_bytes().startswith(b"\x89PNG")
    rows = (out / "sequential.csv").read_text().splitlines()
    assert rows[0] == "test,channel,time_s,sample_sigmas,statistic,threshold"
    assert len(rows) > 17 * 190
    assert sequential(files, "-o", out) != 0
    assert "add --force" in capsys.readouterr().err


def test_a_clean_flight_in_words(files, tmp_path, capsys):
    words = ("--sequential-rule", "cusum", "-o", tmp_path / "out")
    assert sequential(files, *words, observations="clean.rnx") == 0
    said = capsys.readouterr().out
    assert "Verdict: clean" in said and "report.html" in said
    report = (tmp_path / "out/report.html").read_text(encoding="utf-8")
    assert "No spoofing found" in report and "no test has alarmed" in report


def test_an_ins_of_a_grade(files, tmp_path, capsys):
    out = tmp_path / "out"
    assert sequential(files, "--ins-grade", "navigation", "-o", out, "--json") == 0
    assert json.loads(capsys.readouterr().out)["satellites"] == [files[1]]
    assert "a free one of grade “navigation”" in (out / "report.html").read_text(encoding="utf-8")
    assert sequential(files, "--ins-grade", "best") != 0
    assert "no IMU grade 'best'" in capsys.readouterr().err


def test_what_is_wrong_is_said(files, tmp_path, capsys):
    assert sequential(files, "--sequential-rule", "magic") != 0
    assert "known rules" in capsys.readouterr().err
    assert sequential(files, "--dme", tmp_path / "none.csv") != 0
    error = capsys.readouterr().err
    assert "cannot be read" in error and "Traceback" not in error


SMALL = {"duration_s": 2.5, "sample_rate_hz": 4.2e6, "lo_hz": 1561.098e6, "sample_format": "c2"}
DME = [
    {"name": "A", "latitude_deg": 40.5, "longitude_deg": 116.5},
    {"name": "B", "latitude_deg": 39.5, "longitude_deg": 117.5, "noise": 0.0, "bias_m": 20.0},
]


def scenario(dme, **sky_table):
    table = {"start": "2023-03-12T12:00:00", "receiver": PLACE | {"kind": "static"}}
    table |= {"signals": ["B1I"]} | VACUUM | sky_table
    raw = {"recording": RECORDING | SMALL | {"duration_s": 0.5}, "sky": table, "dme": dme}
    return Scenario.model_validate(raw)


def test_stations_of_a_scenario():
    made = scenario(DME)
    log = dme_of(made, duration_s=300.0)
    assert log.reference == made.sky.start_time
    assert [s.name for s in log.stations] == ["A", "B"]
    assert log.time_s.size == 602
    assert np.all(np.diff(log.time_s) >= 0.0)
    place = made.sky_model().trajectory.body(np.zeros(1))
    true = slant_ranges_m(log.stations, place)[0]
    a, b = (log.range_m[log.station == k] for k in (0, 1))
    np.testing.assert_allclose(b, true[1] + 20.0, atol=1e-6)
    sigma = float(sigma_m(true[0]))
    assert a.std() == pytest.approx(sigma, rel=4 / 600**0.5)
    assert a.mean() == pytest.approx(true[0], abs=4 * sigma / 301**0.5)
    np.testing.assert_array_equal(dme_of(made, duration_s=10.0).range_m, log.range_m[:22])
    assert dme_of(scenario([])) is None


def test_synth_writes_the_ranges(tmp_path):
    made = scenario(DME)
    meta = synthesize(made, tmp_path / "rec", threads=1)
    log = read_dme(dme_path(meta))
    np.testing.assert_allclose(log.range_m, dme_of(made).range_m, atol=1e-3)
    assert log.reference == made.sky.start_time


def test_bad_stations_are_refused():
    with pytest.raises(ValidationError, match="appears twice"):
        scenario([DME[0], DME[0]])
    with pytest.raises(ValidationError, match="name"):
        scenario([DME[0] | {"name": "a b"}])
    with pytest.raises(ValidationError, match=r"\[\[dme\]\] needs a \[sky\]"):
        Scenario.model_validate({"recording": RECORDING | SMALL, "dme": DME})


def test_geodetic_place_of_a_station():
    np.testing.assert_allclose(
        STATIONS[0].position_m, geodetic_to_ecef(np.array([40.5, 116.5, 50.0]))
    )
