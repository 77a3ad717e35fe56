"""What is said of a campaign, against tables made by hand."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import binomtest

from sdr_spoof.campaign.analysis import (
    coverage_table,
    detection_table,
    latency_table,
    roc_table,
    wilson,
    write_csv,
)
from sdr_spoof.campaign.figures import longest_axis, with_unit
from sdr_spoof.campaign.report import write_analysis
from sdr_spoof.campaign.table import Table
from sdr_spoof.campaign.trials import Trials, trials

NAN = float("nan")


def by_hand(**changes: Any) -> Table:
    """Two points of four runs; C27 is attacked from 1 s, dragged from 3 s, and C19 is not."""
    columns: dict[str, Any] = {
        "point": np.repeat([0, 1], 4),
        "run": np.tile(np.arange(4), 2),
        "seed": np.arange(8),
        "error": np.array(["", "", "", "", "", "", "", "E: no"]),
        "rate": np.repeat([0.5, 2.0], 4),
        "C27.verdict": np.array(["spoofed", "clean", "spoofed", "spoofed", *["spoofed"] * 3, ""]),
        "C27.alarm_s": np.array([4.0, NAN, 2.5, 0.5, 3.5, 4.5, 5.5, NAN]),
        "C27.attack": np.array(["induced"] * 7 + [""]),
        "C27.hostile": np.array([1] * 7 + [-1], np.int8),
        "C27.attack_start_s": np.array([1.0] * 7 + [NAN]),
        "C27.drag_start_s": np.array([3.0] * 7 + [NAN]),
        "C27.glr.alarmed": np.array([1, 0, 1, 1, 1, 1, 1, -1], np.int8),
        "C27.glr.alarm_s": np.array([4.0, NAN, 2.5, 0.5, 3.5, 4.5, 5.5, NAN]),
        "C27.glr.score": np.array([2.0, 0.9, 3.0, 1.5, 4.0, 5.0, 6.0, NAN]),
        "C19.verdict": np.array(["clean"] * 6 + ["spoofed", ""]),
        "C19.attack": np.array([""] * 8),
        "C19.hostile": np.array([0] * 7 + [-1], np.int8),
        "C19.attack_start_s": np.full(8, NAN),
        "C19.drag_start_s": np.full(8, NAN),
        "C19.glr.alarmed": np.array([0] * 6 + [1, -1], np.int8),
        "C19.glr.alarm_s": np.array([NAN] * 6 + [7.0, NAN]),
        "C19.glr.score": np.array([0.1, 0.2, 0.95, 0.3, 0.4, NAN, 1.1, NAN]),
    }
    spec = {"campaign": {"title": "By hand"}, "sweep": [{"key": "k", "name": "rate"}]}
    return Table(("rate",), columns | changes, False, spec)


def row_of(rows: list[dict[str, Any]], **values: Any) -> dict[str, Any]:
    (row,) = [r for r in rows if all(r[name] == value for name, value in values.items())]
    return row


def test_wilson_is_that_of_scipy() -> None:
    for count, n in [(0, 10), (3, 10), (10, 10), (1, 500), (499, 500)]:
        expected = binomtest(count, n).proportion_ci(0.95, method="wilson")
        low, high = wilson(count, n)
        assert (float(low), float(high)) == pytest.approx((expected.low, expected.high), abs=1e-12)
    low, high = wilson([0, 0], [0, 5])
    assert (low[0], high[0], low[1]) == (0.0, 1.0, 0.0)


def test_wilson_covers_the_truth_as_often_as_it_says() -> None:
    rng = np.random.default_rng(4)
    counts = rng.binomial(50, 0.9, 4000)
    low, high = wilson(counts, np.full(4000, 50))
    share = float(np.mean((low <= 0.9) & (high >= 0.9)))
    assert abs(share - 0.9703) < 4 * (0.97 * 0.03 / 4000) ** 0.5  # exactly, by the binomial law


def test_detection() -> None:
    rows = detection_table(by_hand(), trials(by_hand()))
    slow = row_of(rows, point=0, what="induced", detector="glr")
    assert (slow["rate"], slow["alarm_trials"], slow["alarm_count"]) == (0.5, 4, 2)
    assert slow["alarm"] == 0.5
    assert slow["early_count"] == 1  # at 0.5 s, before the attack
    assert slow["median_on_air_s"] == pytest.approx((3.0 + 1.5) / 2)
    assert slow["median_drag_s"] == pytest.approx((1.0 - 0.5) / 2)
    fast = row_of(rows, point=1, what="induced", detector="glr")
    assert (fast["alarm_trials"], fast["alarm_count"]) == (3, 3)  # the failed run does not count
    clean = row_of(rows, point=1, what="", detector="glr")
    assert (clean["alarm_trials"], clean["alarm_count"], clean["hostile"]) == (3, 1, False)
    fused = row_of(rows, point=0, what="induced", detector="verdict")
    assert fused["alarm_count"] == 2


def test_any_alarm_counts_suspicions_by_the_first_of_all_tests() -> None:
    suspect = np.array(["spoofed", "suspect", "spoofed", "spoofed", *["spoofed"] * 3, ""])
    table = by_hand(
        **{
            "C27.verdict": suspect,
            "C27.power.alarmed": np.array([1, 1, 0, 0, 0, 0, 0, -1], np.int8),
            "C27.power.alarm_s": np.array([2.0, 3.0, *[NAN] * 6]),
        }
    )
    first = row_of(detection_table(table, trials(table)), point=0, what="induced", detector="any")
    assert (first["alarm_trials"], first["alarm_count"]) == (4, 3)  # one was early
    assert first["median_on_air_s"] == pytest.approx(1.5)  # 1.0, 2.0 and 1.5


def test_latency() -> None:
    rows = latency_table(by_hand(), trials(by_hand()))
    fast = row_of(rows, **{"point": 1, "detector": "glr", "from": "drag"})
    assert (fast["trials"], fast["found"]) == (3, 3)
    assert [fast[q] for q in ("q25_s", "q50_s", "q75_s")] == pytest.approx([1.0, 1.5, 2.0])
    assert (fast["before"], fast["within_trials"], fast["within_count"]) == (0, 3, 2)  # 2 s
    slow = row_of(rows, **{"point": 0, "detector": "glr", "from": "drag"})
    assert (slow["before"], slow["within_trials"], slow["within_count"]) == (1, 4, 1)
    on_air = row_of(rows, **{"point": 1, "detector": "glr", "from": "on air"})
    assert on_air["q50_s"] == pytest.approx(3.5)


def test_coverage_by_kind_by_label_and_of_multipath() -> None:
    (row,) = [r for r in coverage_table(by_hand(), trials(by_hand())) if r["detector"] == "glr"]
    assert (row["what"], row["alarm_trials"], row["alarm_count"]) == ("induced", 7, 5)
    table = by_hand(rate=np.repeat(["slow", "fast"], 4))
    axis = {"key": "scenario.attack", "name": "rate", "labels": ["slow", "fast"]}
    labelled = Table(table.axes, table.columns, False, {**table.spec, "sweep": [axis]})
    rows = coverage_table(labelled, trials(labelled))
    assert [r["what"] for r in rows if r["detector"] == "glr"] == ["slow", "fast"]
    kinds = np.array(["induced"] * 4 + ["multipath"] * 3 + [""])
    hostile = np.array([1] * 4 + [0] * 3 + [-1], np.int8)
    mixed = by_hand(**{"C27.attack": kinds, "C27.hostile": hostile})
    rows = coverage_table(mixed, trials(mixed))
    assert [(r["what"], r["hostile"]) for r in rows if r["detector"] == "glr"] == [
        ("induced", True),
        ("multipath", False),
    ]


def test_roc() -> None:
    rows = roc_table(by_hand(), trials(by_hand()))
    curve = [r for r in rows if r["point"] == 0 and r["detector"] == "glr"]
    assert [r["threshold"] for r in curve] == [3.0, 2.0, 1.5, 0.95, 0.9, 0.3, 0.2, 0.1]
    assert [r["pd"] for r in curve] == [0.25, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0, 1.0]
    assert [r["pfa"] for r in curve] == [0, 0, 0, 0.25, 0.25, 0.5, 0.75, 1.0]
    # Not tested is no statistic at all: below any threshold.
    fast = [r for r in rows if r["point"] == 1 and r["detector"] == "glr"]
    assert [r["pfa"] for r in fast if r["threshold"] == 0.4] == [pytest.approx(2 / 3)]
    assert not [r for r in rows if r["detector"] == "verdict"]  # has no statistic


def test_roc_against_the_clean_satellites_of_other_points() -> None:
    table = by_hand()
    struck = {"C19.attack": np.array(["induced"] * 4 + [""] * 4)}
    hostile = {"C19.hostile": np.array([1] * 4 + [0] * 3 + [-1], np.int8)}
    table = by_hand(**struck, **hostile)
    curve = [r for r in roc_table(table, trials(table)) if r["point"] == 0]
    assert {r["pfa_trials"] for r in curve} == {3}


def test_columns_that_were_not_kept() -> None:
    table = by_hand()
    kept = {n: c for n, c in table.columns.items() if not n.endswith(("alarm_s", "score"))}
    few = Table(table.axes, kept, False, table.spec)
    row = row_of(detection_table(few, trials(few)), point=0, what="induced", detector="glr")
    assert row["alarm_count"] == 3
    assert np.isnan(row["median_on_air_s"])
    assert roc_table(few, trials(few)) == []
    none = {n: c for n, c in kept.items() if not n.endswith(("alarmed", "verdict"))}
    nothing = trials(Table(table.axes, none, False, table.spec))
    assert isinstance(nothing, Trials)
    assert nothing.point.size == 0


def test_files(tmp_path: Path) -> None:
    analysis = write_analysis(tmp_path, by_hand())
    names = {p.name for p in analysis.files}
    assert names == {p.name for p in tmp_path.iterdir()}
    assert {"detection.png", "roc.png", "coverage.png", "latency.png", "latency_drag.png"} < names
    with (tmp_path / "detection.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12
    assert [r["median_on_air_s"] for r in rows if r["point"] == "0" and not r["what"]] == [""] * 3
    before = (tmp_path / "roc.png").read_bytes()
    write_analysis(tmp_path, by_hand())
    assert (tmp_path / "roc.png").read_bytes() == before
    without = by_hand(error=np.full(8, "E: all failed"))
    assert {p.suffix for p in write_analysis(tmp_path, without).files} == {".csv"}
    assert not list(tmp_path.glob("*.png"))


def test_csv_of_nothing(tmp_path: Path) -> None:
    write_csv(tmp_path / "a.csv", [])
    assert (tmp_path / "a.csv").read_text().strip() == ""


def test_words() -> None:
    assert with_unit("drag_rate_m_s") == "drag rate (m/s)"
    assert with_unit("cn0_dbhz") == "C/N0 (dB-Hz)"
    assert with_unit("power_db") == "power (dB)"
    assert with_unit("window_s") == "window (s)"
    assert with_unit("false_alarm_probability") == "false alarm probability"
    rows = [{"a": float(k), "b": float(k // 2), "c": str(k)} for k in range(4)]
    assert longest_axis(rows, ["b", "a", "c"]) == "a"
    assert longest_axis(rows, ["c"]) is None
    assert longest_axis(rows[:1], ["a"]) is None
