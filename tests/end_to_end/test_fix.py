"""``sdr-spoof fix``: from the tracks of a result file to the files that others read."""

from __future__ import annotations

import json
from pathlib import Path

import georinex
import numpy as np
import pytest
from commands import failing, run

from sdr_spoof import simulate
from sdr_spoof.nav.geodesy import enu, geodetic_to_ecef
from sdr_spoof.nav.rinex_nav import read_navigation
from sdr_spoof.records import SatelliteVerdict, Verdict
from sdr_spoof.scenario import load_scenario
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sinks.rinex_obs import UNSETTLED_M
from sdr_spoof.sources import RecordingFormat

PLACE = (31.2, 121.5, 30.0)
SKY = """
title = "fix"
[recording]
duration_s = 36.0
sample_rate_hz = 10e6
lo_hz = 1561.098e6
sample_format = "ci8"
seed = 3
[sky]
start = "2023-03-12T12:00:00"
systems = ["C"]
signals = ["B1I"]
elevation_mask_deg = 25.0
[sky.receiver]
kind = "static"
latitude_deg = 31.2
longitude_deg = 121.5
height_m = 30.0
"""
FILES = {
    "observations.rnx",
    "navigation.rnx",
    "navigation4.rnx",
    "track.nmea",
    "track.geojson",
    "track.kml",
    "fixes.csv",
    "observations.csv",
    "fixes.h5",
}


@pytest.fixture(scope="module")
def result_file(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("fix")
    (folder / "sky.toml").write_text(SKY)
    log = simulate(load_scenario(folder / "sky.toml"))
    form = RecordingFormat(sample_format="ci8", sample_rate_hz=10e6, lo_hz=1561.098e6)
    verdict = Verdict(True, (SatelliteVerdict(27, "spoofed", (), "", onset_s=20.0),), "")
    path = folder / "result.h5"
    write_result(path, Result("rec.sigmf-data", form, {}, log=log, verdict=verdict))
    return path


@pytest.fixture(scope="module")
def written(result_file):
    folder = result_file.parent / "out"
    done = run("fix", result_file, "-o", folder, "--rate", "2", "--json")
    assert done.returncode == 0, done.stderr
    return folder, json.loads(done.stdout)


def test_summary_is_the_only_thing_on_stdout(written):
    folder, told = written
    position = told["position"]
    assert position["fixes"] == position["epochs"] >= 68
    assert position["left_out"] == ["C27"]
    place = (position["latitude_deg"], position["longitude_deg"], position["height_m"])
    error = enu(geodetic_to_ecef(place), geodetic_to_ecef(PLACE))
    assert np.hypot(*error[:2]) < 5.0
    assert {Path(p).name for p in told["files"]} == FILES
    assert {p.name for p in folder.iterdir()} == FILES


@pytest.mark.filterwarnings("ignore")
def test_files_agree(written):
    folder, _ = written
    seen = read_result(folder / "fixes.h5").observations
    read = georinex.load(folder / "observations.rnx", use="C")
    for i, signal in enumerate(seen.signals):
        theirs = read["C2I"].sel(sv=signal.satellite).values
        blank = seen.spoofed[:, i] | (seen.unsettled_m[:, i] > UNSETTLED_M)
        ours = np.where(blank, np.nan, seen.pseudorange_m[:, i])
        assert np.allclose(theirs, ours, atol=6e-4, equal_nan=True)
    ephemerides = read_navigation(folder / "navigation4.rnx").ephemerides
    assert {e.prn for e in ephemerides} == {s.prn for s in seen.signals}


def test_the_same_file_again(written, result_file):
    folder, _ = written
    again = folder.with_name("again")
    done = run("fix", result_file, "-o", again, "--rate", "2", "--threads", "2")
    assert done.returncode == 0, done.stderr
    assert "Left out as spoofed: C27" in done.stdout
    for name in FILES:
        assert (folder / name).read_bytes() == (again / name).read_bytes(), name


def test_mistakes_are_told(written, result_file, tmp_path, capsys):
    folder, _ = written
    out = ("-o", tmp_path / "a")
    assert "--force" in failing(capsys, "fix", result_file, "-o", folder)[1]
    code, message = failing(capsys, "fix", folder / "fixes.h5", *out)
    assert code == 1 and "holds no tracks" in message
    for flags in (["--rate", "51"], ["--place", "95,0,0"], ["--time", "noon"], ["--format", "gpx"]):
        code, message = failing(capsys, "fix", result_file, *out, *flags)
        assert code == 2 and flags[1].split(",")[0] in message
    code, message = failing(capsys, "fix", result_file, *out, "--nav", tmp_path / "none.rnx")
    assert code == 1 and "none.rnx" in message
    assert not (tmp_path / "a").exists()
