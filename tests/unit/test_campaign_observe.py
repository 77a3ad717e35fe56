"""What a run writes down, of the simulated tracks that the detectors are tested with."""

from __future__ import annotations

from pathlib import Path

import pytest
from campaign_runs import SPEC, spec_file
from simulated_tracks import Attack, Satellite, simulate_log

from sdr_spoof.campaign import plan_campaign
from sdr_spoof.campaign.columns import columns_of
from sdr_spoof.campaign.points import Point
from sdr_spoof.campaign.run import observe, truths
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.fusion import share_of
from sdr_spoof.verdict import detect


def point(folder: Path, detectors: str = '["phase_difference_rate"]', text: str = SPEC) -> Point:
    text += f"[detection]\ndetectors = {detectors}\n"
    return plan_campaign(spec_file(folder, text)).points[0]


def test_verdict_alarm_and_score(tmp_path: Path) -> None:
    log = simulate_log(Satellite(27, attack=Attack()), Satellite(19))
    at = point(tmp_path)
    row = observe(at, log)
    assert list(row) == [c.name for c in columns_of(at)]
    expected = {s.prn: s for s in detect(log, at.detection).satellites}
    (alarm,) = expected[27].alarms
    assert row["C27.verdict"] == "spoofed"
    assert row["C27.alarm_s"] == row["C27.phase_difference_rate.alarm_s"] == alarm.alarm_s
    assert row["C27.onset_s"] == expected[27].onset_s
    assert row["C27.band"] == (expected[27].band or "")
    assert row["C27.phase_difference_rate.alarmed"] is True
    assert row["C27.phase_difference_rate.score"] >= abs(alarm.statistic / alarm.threshold)
    assert row["C19.verdict"] == "clean"
    assert row["C19.phase_difference_rate.alarmed"] is False
    assert 0 < row["C19.phase_difference_rate.score"] < 1
    assert row["C19.phase_difference_rate.alarm_s"] is None
    assert row["C19.phase_difference_rate.tested_s"] == pytest.approx(log.duration_s, abs=1.0)


def test_a_score_of_one_is_the_threshold(tmp_path: Path) -> None:
    """The same log with a false-alarm probability that puts the threshold at its largest value."""
    log = simulate_log(Satellite(27), Satellite(19))
    both = point(tmp_path, '["phase_difference_rate", "code_difference"]')
    for name in ("C27.phase_difference_rate", "C19.code_difference"):
        row = observe(both, log)
        assert (row[f"{name}.score"] > 1) == row[f"{name}.alarmed"]
    halved = share_of(DetectionConfig(detectors=("a", "b")))
    assert halved.false_alarm_probability == DetectionConfig().false_alarm_probability / 2


def test_a_satellite_that_was_not_tracked(tmp_path: Path) -> None:
    row = observe(point(tmp_path), simulate_log(Satellite(27)))
    assert row["C19.verdict"] is None
    assert row["C19.phase_difference_rate.alarmed"] is False
    assert row["C19.phase_difference_rate.score"] is None
    assert row["C19.phase_difference_rate.tested_s"] == 0.0
    assert row["C19.B1I.held_until_s"] is None


def test_truth(tmp_path: Path) -> None:
    more = (
        '[[scenario.attack]]\nkind = "multipath"\nprn = 19\n'
        "[[scenario.attack.ray]]\ndelay_m = 100.0\nratio = 0.7\nstart_s = 2.0\n"
    )
    found = truths(point(tmp_path, text=SPEC + more).scenario)
    assert found["C27"] == {
        "attack": "induced",
        "hostile": True,
        "attack_start_s": 1.0,
        "capture_s": pytest.approx(1.0 + 2.0 * 20 / 23.5),
        "drag_start_s": 4.0,
    }
    assert (found["C19"]["attack"], found["C19"]["hostile"]) == ("multipath", False)
    assert found["C19"]["attack_start_s"] == 2.0
