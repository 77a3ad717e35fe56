"""``process`` on real recordings of one band: no verdict, but everything else."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from sdr_spoof.cli import main
from sdr_spoof.sinks.hdf5 import read_result

RECORDINGS = Path(__file__).parents[1] / "vectors" / "recordings"


@pytest.mark.parametrize(
    ("name", "prns"),
    [
        ("L1_20211202_084700_4MHz_IQ.bin", "26,30,31,36"),
        ("L1_20211125_004000_12MHz_I.bin", "13,32,38"),
    ],
)
def test_one_band_ends_without_a_verdict(
    name: str, prns: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["process", str(RECORDINGS / name), "--prns", prns, "-o", str(out), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert not data["partial"]
    assert data["verdict"]["spoofed"] is False
    assert {s["verdict"] for s in data["verdict"]["satellites"]} == {"not enough support"}
    # Code against carrier could test one band, had it been longer.
    reasons = {s["reason"].split("; longest")[0] for s in data["verdict"]["satellites"]}
    assert reasons == {
        f"received on {s} only; the test compares two bands" for s in ("B1C", "L1CA")
    }
    result = read_result(data["result"])
    assert result.verdict is not None
    assert len(result.verdict.satellites) == len(data["verdict"]["satellites"])
    report = Path(data["report"]).read_text(encoding="utf-8")
    words = re.sub(r"data:image/png;base64,[^\"]+|<style>.*?</style>", "", report, flags=re.S)
    assert "Not enough support for a verdict" in words
    assert not re.search(
        r"\b(nan|inf)\b", re.sub(r"<details><summary>Eff.*", "", words, flags=re.S)
    )
