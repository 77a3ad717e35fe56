"""The whole way: a scenario with an induced attack, synthesised, processed as unknown, judged."""

import json

import pytest

from sdr_spoof.config import Config
from sdr_spoof.pipeline import process
from sdr_spoof.scenario import builtin_scenario, synthesize
from sdr_spoof.sources import open_recording


@pytest.fixture(scope="module")
def attacked(tmp_path_factory):
    """The quick scenario on disk, and its truth."""
    path = synthesize(builtin_scenario("quick"), tmp_path_factory.mktemp("attack") / "quick")
    return path, json.loads(path.with_name("quick.truth.json").read_text())


@pytest.fixture(scope="module")
def processed(attacked, tmp_path_factory):
    recording = open_recording(attacked[0])
    return process(recording, Config(), out=tmp_path_factory.mktemp("first"), threads=1)


def test_the_spoofed_satellite_band_and_time_are_found(attacked, processed):
    (attack,) = attacked[1]["attacks"]
    verdict = processed.verdict
    assert verdict.spoofed
    found = {s.prn: s for s in verdict.satellites}
    assert {p for p, s in found.items() if s.verdict == "spoofed"} == {attack["prn"]}
    assert all(s.verdict == "clean" for p, s in found.items() if p != attack["prn"])
    satellite = found[attack["prn"]]
    alarm = satellite.alarms[0]
    assert satellite.band in attack["components"]
    assert satellite.fallback == "B1I"
    assert alarm.band in attack["components"]
    # Not before it is on the air (but for the length of an integration); seen by the drag.
    assert attack["start_s"] - 0.02 < alarm.onset_s < attack["drag_start_s"]
    assert alarm.onset_s < alarm.alarm_s < attack["drag_full_s"]


def test_two_runs_give_the_same_files(attacked, processed, tmp_path):
    recording = open_recording(attacked[0])
    again = process(recording, Config(), out=tmp_path / "again", threads=2)
    for a, b in (
        (processed.result_path, again.result_path),
        (processed.report_path, again.report_path),
    ):
        assert a.read_bytes() == b.read_bytes(), a.name
