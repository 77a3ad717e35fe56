"""The same sky in every sample format gives the same verdict, on the way that users take."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import sdr_spoof
from sdr_spoof.cli import main

SCENARIO = """
[recording]
duration_s = 3.5
sample_rate_hz = {rate}
lo_hz = {lo}
sample_format = "{name}"
seed = 11

[[satellite]]
prn = 27
range_rate_m_s = 96.1
delay_ms = 74.263

[[attack]]
prn = 27
signals = ["B1C"]
start_s = 2.0
power_start_db = -10.0
power_db = 3.5
power_ramp_s = 0.5
carrier_phase_cycles = 0.25
"""
"""A quarter of a cycle is the phase that moves the captured carrier most without losing it."""


@pytest.mark.parametrize("name", ["ri8", "ci8", "ri16", "ci16", "rf32", "cf32", "r2", "c2"])
def test_every_format_gives_the_same_verdict(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rate, lo = ("40e6", "1558.259e6") if name[0] == "r" else ("20e6", "1568.259e6")
    scenario = tmp_path / "scenario.toml"
    scenario.write_text(SCENARIO.format(rate=rate, lo=lo, name=name))
    assert main(["synth", str(scenario), "-o", str(tmp_path / "sky"), "--json"]) == 0
    recording = json.loads(capsys.readouterr().out)["recording"]
    if name == "cf32":  # a receiver whose full scale is 1, and far below it
        data = np.memmap(Path(recording).with_suffix(".sigmf-data"), "<f4", "r+")
        data *= np.float32(1e-3)
        data.flush()
    log, verdict = _processed(recording)
    (satellite,) = verdict.satellites
    assert satellite.verdict == "spoofed"
    assert satellite.band == "B1CP"
    (rate,) = (a for a in satellite.alarms if a.detector == "phase_difference_rate")
    assert 1.95 < rate.onset_s < 2.5
    # Two bits cost about half a decibel, 8 bits nothing that shows.
    quiet = log.combos[0].time_s < 1.9
    cn0_dbhz = np.median(log.combos[0].cn0_lower_dbhz[quiet])
    assert cn0_dbhz == pytest.approx(44.4 if name in ("r2", "c2") else 45.0, abs=0.7)


def _processed(recording: str) -> tuple[sdr_spoof.TrackLog, sdr_spoof.Verdict]:
    source = sdr_spoof.open_recording(recording)
    config = sdr_spoof.load_config()
    found = sdr_spoof.acquire(source, config.acquisition, prns=[27], threads=2)
    log = sdr_spoof.track(source, found, config.tracking, threads=2)
    return log, sdr_spoof.detect(log, config.detection)
