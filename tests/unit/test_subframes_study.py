"""The study of subframes against C/N0, in short."""

import json

import pytest
from scipy.stats import norm

from sdr_spoof.studies import subframes


def test_rates_are_where_the_study_says() -> None:
    points = {p.message: p for p in subframes.measure([6.0], 240)}
    assert set(points) == {"D1", "D2", "LNAV"}
    assert points["D1"].cn0_dbhz == 22.99
    assert points["D2"].cn0_dbhz == 32.99
    for p in points.values():
        assert p.subframes == 238
        assert p.wrong == 0
        assert p.found_rate > 0.99
    # 4 standard errors below 92 % and 69 % of 238 subframes.
    assert points["D1"].taken_rate > 0.85
    assert points["D2"].taken_rate > 0.85
    assert points["LNAV"].taken_rate > 0.57
    # Hard decisions lose any LNAV subframe with an error.
    p = norm.sf((2 * 10**0.6) ** 0.5)
    assert points["LNAV"].hard_rate == pytest.approx(1 - (1 - p) ** 300, abs=4 * 0.5 / 238**0.5)


def test_the_study_is_written(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(subframes, "ES_N0_DB", (8.0,))
    result = subframes.run(tmp_path, subframes=120)
    assert json.loads((tmp_path / "subframes.json").read_text()) == result
    assert len(result["points"]) == 3
