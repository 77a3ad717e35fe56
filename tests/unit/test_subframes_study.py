"""The study of subframe errors, in short."""

from __future__ import annotations

from pathlib import Path

import pytest

from sdr_spoof.studies import subframes


@pytest.mark.parametrize("code", ["D1", "LNAV"])
def test_most_likely_words_beat_decisions_by_sign(code: str) -> None:
    point = subframes.measure(code, 4.5, 400)
    assert point.wrong_rate < 0.5 * point.hard_rate
    assert point.wrong_rate <= point.lost_rate
    assert point.undetected == 0


def test_results_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subframes, "ES_N0_DB", (5.0,))
    result = subframes.run(tmp_path, subframes=200)
    assert [p["cn0_dbhz"] for p in result["points"]] == pytest.approx([21.99, 21.99], abs=0.01)
    files = {p.name for p in tmp_path.iterdir()}
    assert files == {"subframes.json", "subframes.csv", "subframes.png"}
