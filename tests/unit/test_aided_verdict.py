"""The rule of aided verdicts, its words, and the files."""

from __future__ import annotations

import csv
from dataclasses import replace

import aided_case as case
import h5py
import numpy as np
import pytest

from sdr_spoof.aided.files import COLUMNS, SMOOTHED, write_csv, write_hdf5
from sdr_spoof.aided.judge import judge
from sdr_spoof.aided.records import Guard, Use
from sdr_spoof.aided.session import Session
from sdr_spoof.config import Config
from sdr_spoof.errors import OutputError
from sdr_spoof.nav.geodesy import geodetic_to_ecef
from sdr_spoof.report import aided_words as words
from sdr_spoof.report.aided import write_aided_report

QUIET = np.full(case.EPOCHS, Guard.TRUSTED, np.uint8)
ALL_USED = np.full((case.EPOCHS, len(case.NAMES)), Use.USED, np.uint8)


def test_satellites_that_were_left_out_are_spoofed():
    verdict = case.aided().verdict
    assert verdict.verdict == "spoofed" and not verdict.everybody
    assert verdict.satellites == ("C20", "C27", "C36")
    assert verdict.onset_s == 61.0 and verdict.alarm_s == 61.0
    assert verdict.severity_m == pytest.approx(78.0, abs=4.0)
    assert verdict.confidence == pytest.approx(1 - 1e-6)
    told = " ".join(words.sentences(verdict))
    assert told.startswith("C20, C27, C36, since 61.0 s (alarm at 61.0 s). Severity: GNSS alone")
    assert told.endswith("Spoofed by the receiver's own detectors, and not used: C23.")
    assert words.action(verdict).startswith("leave C20, C23, C27, C36 out")


def test_what_the_receiver_named_is_not_taken_for_clean():
    use = ALL_USED.copy()
    use[70:, 2] = Use.NAMED
    verdict = judge(case.track(QUIET, use), [case.monitor()])
    assert verdict.verdict == "clean" and verdict.heeded == ("C23",)
    assert words.headline(verdict) == "No spoofing beside what the receiver itself has found"
    assert "C23" in verdict.reason and "C23" in next(words.sentences(verdict))


def test_all_satellites():
    guard = QUIET.copy()
    guard[62:66], guard[66:110] = Guard.DECIDING, Guard.COASTING
    use = ALL_USED.copy()
    use[62:110] = Use.EXCLUDED
    verdict = judge(case.track(guard, use), [case.monitor(alarm_s=62.0)])
    assert verdict.everybody and not verdict.satellites
    assert "All satellites" in next(words.sentences(verdict))
    assert words.action(verdict).startswith("use no GNSS")
    assert "none was believed" in verdict.reason


def test_an_alarm_that_was_taken_back_is_a_suspicion():
    guard = QUIET.copy()
    guard[62:90] = Guard.DECIDING
    verdict = judge(case.track(guard, ALL_USED), [case.monitor(alarm_s=62.0)])
    assert verdict.verdict == "suspect" and "taken back" in verdict.reason
    assert words.headline(verdict) == "Suspicious signals"


def test_rates_alone():
    verdict = judge(None, [case.monitor("east", "m/s", 62.0)])
    assert verdict.verdict == "spoofed" and verdict.severity_m is None
    assert "cannot be told" in next(words.sentences(verdict))


def test_clean_and_not_enough_support():
    clean = judge(case.track(QUIET, ALL_USED), [case.monitor()])
    assert clean.verdict == "clean" and list(words.sentences(clean)) == []
    assert clean.tested_s == case.EPOCHS - 1
    short = judge(None, [case.monitor(tested=5)], ["the INS was aligned 900 s ago"])
    assert short.verdict == "not enough support"
    assert short.reason.endswith("10 s are needed: the INS was aligned 900 s ago")
    assert words.level(short) == "unsupported"
    assert judge(None, []).verdict == "not enough support"


def test_a_weak_alarm_says_how_weak():
    verdict = judge(None, [case.monitor("east", "m/s", 62.0, log10_p=-3.0)], tests=10)
    assert "probability of 0.01" in words.sureness(verdict)


def test_every_epoch_is_a_row_of_the_csv(tmp_path):
    path = tmp_path / "a.csv"
    write_csv(path, case.track())
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert len(rows) == case.EPOCHS and tuple(rows[0]) == COLUMNS
    row = rows[80]
    place = [float(row[c]) for c in ("latitude_deg", "longitude_deg", "height_m")]
    assert np.linalg.norm(geodetic_to_ecef(place) - case.track().position_m[80]) < 2e-3
    assert row["left_out"] == "C20 C23 C27 C36" and row["filter"] == "partial"
    assert row["used"].split() == ["C19", "C25", "C30", "C37", "G05", "G12"]
    with pytest.raises(OutputError, match="--force"):
        write_csv(path, case.track())


def test_a_smoothed_track_is_in_all_files(tmp_path):
    found = replace(case.aided(), track=replace(case.track(), smoothed=case.smoothed()))
    write_csv(tmp_path / "a.csv", found.track)
    rows = list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))
    assert tuple(rows[0]) == (*COLUMNS, *SMOOTHED)
    place = [
        float(rows[80][f"smoothed_{c}"]) for c in ("latitude_deg", "longitude_deg", "height_m")
    ]
    assert np.linalg.norm(geodetic_to_ecef(place) - case.smoothed().position_m[80]) < 2e-3
    assert rows[80]["smoothed_sigma_up_m"] == "0.200"
    write_hdf5(tmp_path / "a.h5", found, {})
    with h5py.File(tmp_path / "a.h5") as file:
        np.testing.assert_array_equal(file["track/smoothed/position_m"], case.smoothed().position_m)
    path = tmp_path / "aided.html"
    write_aided_report(path, found, names=("a", "b"), config={}, truth_m=case.truth_m())
    text = path.read_text(encoding="utf-8")
    assert text.count("Smoothed: what is known afterwards") == 2
    session = Session(found, Config(), ("a", "b"), truth_m=case.truth_m())
    assert session.error_m["smoothed"] == pytest.approx(0.1)


def test_hdf5_holds_every_record(tmp_path):
    found = case.aided()
    for name in ("a.h5", "b.h5"):
        write_hdf5(tmp_path / name, found, {"tight": {"risk": 1e-5}})
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()
    with h5py.File(tmp_path / "a.h5") as file:
        assert set(file) == {"config", "verdict", "track", "measurements", "monitors", "residuals"}
        np.testing.assert_array_equal(file["track/use"], found.track.use)
        assert file["track/position_m"].attrs["units"] == "m"
        assert file["verdict/severity_m"][()] == found.verdict.severity_m
        np.testing.assert_array_equal(file["residuals/00/value"], found.residuals[0].value)


def test_the_report(tmp_path):
    path = tmp_path / "aided.html"
    write_aided_report(path, case.aided(), names=("a.rnx", "b.csv"), config={"tight": {"x": 1}})
    text = path.read_text(encoding="utf-8")
    assert text.count("data:image/png") == 5
    for expected in ("Spoofing detected", "C20, C27, C36", "one note", "Slow drags.", "a.rnx"):
        assert expected in text
    with pytest.raises(OutputError, match="--force"):
        write_aided_report(path, case.aided(), names=("a", "b"), config={})
