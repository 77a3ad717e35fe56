"""Overpowered asynchronous spoofing from a recording to the verdict, and the same sky without."""

import json

import pytest
from commands import run

from sdr_spoof import read_result
from sdr_spoof.scenario import Scenario, builtin_scenario, synthesize


def short(attack):
    """The scenario ``asynchronous``, shorter, with two satellites."""
    values = builtin_scenario("asynchronous").model_dump()
    values["recording"]["duration_s"] = 3.5
    values["satellite"] = values["satellite"][:2]
    values["attack"] = [{**a, "start_s": 0.5} for a in values["attack"]] if attack else []
    return Scenario.model_validate(values)


@pytest.mark.parametrize("attack", [True, False], ids=["attack", "clean"])
def test_the_verdict_of_process(attack, tmp_path):
    path = synthesize(short(attack), tmp_path / "sky")
    out = tmp_path / "out"
    flags = ("--acquisition-second-peak-every-s", "4", "--prns", "19,27", "--json")
    done = run("process", path, "-o", out, "--signals", "B1I,B1CP", *flags)
    told = json.loads(done.stdout)
    verdicts = {s["prn"]: s for s in told["verdict"]["satellites"]}
    assert verdicts[19]["verdict"] == "clean"
    assert verdicts[27]["verdict"] == ("spoofed" if attack else "clean")
    peaks = {p.prn: p for p in read_result(out / "result.h5").log.second_peaks}
    assert [p["found"] for p in told["second_peaks"]] == [p.found for p in peaks.values()]
    assert {prn for prn, p in peaks.items() if p.found} == ({27} if attack else set())
    words = "a second signal of this satellite is on the air"
    assert (words in (out / "report.html").read_text()) == attack
