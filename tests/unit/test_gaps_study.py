"""Fixes of recordings with gaps: none is wrong without a flag."""

from __future__ import annotations

import json

import pytest

from sdr_spoof.studies import gaps


@pytest.mark.parametrize(
    ("sky", "known", "seed"),
    [
        # Each had fixes that were called good, and were 42, 133, 1285 and 778 m off, and 1606 km.
        ("L1 C/A", "messages", 19),
        ("L1 C/A", "early gap", 0),
        ("L1 C/A", "early gap", 14),
        ("L1 C/A", "hot", 0),
        ("L1 C/A", "hot", 31),
        ("B1I, D1", "hot", 3),
        ("B1I, D2", "early gap", 1),
        ("B1C", "hot", 2),
        ("all", "hot", 4),
    ],
)
def test_no_fix_is_wrong_without_a_flag(sky, known, seed):
    case = gaps.draw(gaps.SKIES[sky], known, seed)
    found = gaps.judged(gaps.received(gaps.SKIES[sky], known, case)[1])
    assert not found.wrong.any()


def test_recordings_have_fixes():
    """Where no messages follow the gap, the part before it still has some; B1C alone too."""
    found = gaps.measure("B1C", "hot", 3)
    assert found.with_fixes >= 2 and found.wrong == 0
    assert found.unchecked > 0 and found.largest_sigmas < gaps.SIGMAS


def test_gaps_are_as_said():
    for sky in gaps.SKIES.values():
        for known in gaps.KNOWN:
            for seed in range(20):
                case = gaps.draw(sky, known, seed)
                assert all(0.0009 < length_s < 0.3001 for _, length_s in case.gaps)
                assert all(0.0 < at_s < case.duration_s for at_s, _ in case.gaps)
                assert case == gaps.draw(sky, known, seed)


def test_tables(tmp_path, monkeypatch):
    monkeypatch.setattr(gaps, "SKIES", {"B1I, D2": gaps.SKIES["B1I, D2"]})
    monkeypatch.setattr(gaps, "KNOWN", ("hot",))
    table = gaps.run(tmp_path, recordings=1)["gaps"]
    assert json.loads((tmp_path / "gaps.json").read_text())["gaps"] == table
    assert (tmp_path / "gaps.csv").read_text().startswith("sky,known,recordings,with_fixes,good")
