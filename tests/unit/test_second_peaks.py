"""Second signals of a tracked satellite: found where they are, and nothing else."""

from __future__ import annotations

import dataclasses
import math

import pytest

from sdr_spoof import track
from sdr_spoof.acquisition import AcquisitionConfig
from sdr_spoof.acquisition_threshold import log10_probability, threshold
from sdr_spoof.records import SecondPeak
from sdr_spoof.report import words
from sdr_spoof.scenario import Scenario
from sdr_spoof.scenario.live import LiveRecording
from sdr_spoof.second_peaks import second_peaks
from sdr_spoof.studies import tracking as study
from sdr_spoof.verdict import detect

CONFIG = AcquisitionConfig(second_peak_every_s=1.6)
"""One search, at 0.8 s."""
CHIP_M = 299_792_458.0 / 2.046e6


def recorded(cn0_dbhz=45.0, *, attack=(), bandwidth_hz=None):
    plan = Scenario.model_validate(
        {
            "recording": {
                "duration_s": 0.9,
                "sample_rate_hz": 5.03e6,
                "lo_hz": 1561.098e6,
                "sample_format": "ci8",
                "bandwidth_hz": bandwidth_hz,
                "seed": 12,
            },
            "satellite": [
                {
                    "prn": prn,
                    "signals": ["B1I"],
                    "cn0_dbhz": level,
                    "delay_ms": delay_ms,
                    "range_rate_m_s": rate,
                }
                for prn, level, delay_ms, rate in (
                    (19, 45.0, 77.419, -412.7),
                    (27, cn0_dbhz, 74.263, 96.1),
                )
            ],
            "attack": list(attack),
        }
    )
    return plan, LiveRecording(plan, 1)


def searched(plan, recording, config=CONFIG):
    starts = study.seeds(plan)
    first = {a.prn: a for a in reversed(starts)}
    log = track(recording, list(first.values()), threads=1)
    found = second_peaks(recording, log, config, threads=1)
    return dataclasses.replace(log, second_peaks=found), {p.prn: p for p in found}


def counterfeit(delay_ms, cn0_dbhz, rate_m_s=96.1):
    return {
        "kind": "asynchronous",
        "prns": [27],
        "signals": ["B1I"],
        "start_s": 0.0,
        "cn0_dbhz": cn0_dbhz,
        "delay_ms": delay_ms,
        "range_rate_m_s": rate_m_s,
    }


@pytest.mark.parametrize(("cn0_dbhz", "rate_m_s"), [(55.0, 500.0), (45.0, 96.1), (41.0, -300.0)])
def test_a_second_signal_is_found_where_it_is(cn0_dbhz, rate_m_s):
    log, found = searched(*recorded(attack=[counterfeit(74.563, cn0_dbhz, rate_m_s)]))
    assert not found[19].found
    peak = found[27]
    assert peak.found
    moved_chips = (rate_m_s - 96.1) * 0.8 / CHIP_M
    assert peak.code_offset_chips == pytest.approx(0.3 * 2046 + moved_chips, abs=0.6)
    assert peak.doppler_offset_hz == pytest.approx(
        -(rate_m_s - 96.1) * 1561.098e6 / 299_792_458.0, abs=150.0
    )
    assert peak.cn0_dbhz == pytest.approx(cn0_dbhz, abs=2.0)
    verdicts = {s.prn: s for s in detect(log).satellites}
    assert verdicts[27].verdict == "spoofed"
    assert verdicts[27].action == "drop the satellite"
    assert "which of both is true cannot be told" in verdicts[27].reason
    assert "second signal" in words.satellite_sentence(verdicts[27])
    assert verdicts[19].verdict == "not enough support"


def test_what_may_be_a_reflection_is_none():
    _, found = searched(*recorded(attack=[counterfeit(74.263 + 5 / 2046, 45.0)]))
    assert not found[27].found
    assert found[27].log10_p == 0.0 or found[27].statistic < found[27].threshold


@pytest.mark.parametrize("bandwidth_hz", [None, 4e6])
@pytest.mark.parametrize("cn0_dbhz", [45.0, 62.0])
def test_a_lone_signal_leaves_no_second_peak(cn0_dbhz, bandwidth_hz):
    log, found = searched(*recorded(cn0_dbhz, bandwidth_hz=bandwidth_hz))
    assert set(found) == {19, 27}
    assert not any(p.found for p in found.values())
    assert not detect(log).spoofed


def test_none_are_searched_for_where_nobody_wants_it_or_nothing_is_tracked():
    plan, recording = recorded()
    log, found = searched(plan, recording, AcquisitionConfig(second_peak_every_s=0.0))
    assert not found
    assert second_peaks(recording, dataclasses.replace(log, signals=()), CONFIG, threads=1) == ()


def test_the_probability_of_a_statistic_is_the_inverse_of_the_threshold():
    grid = (21, 4096, 20, (0.6, 0.2, 0.0))
    for pfa in (1e-2, 1e-5, 1e-7):
        assert log10_probability(threshold(pfa, *grid), *grid) == pytest.approx(
            math.log10(pfa), abs=1e-3
        )
    assert log10_probability(1e5, *grid) < -28.0
    assert -1.0 < log10_probability(10.0, *grid) <= 0.0


def peak(prn, sample, log10_p, found):
    return SecondPeak("B1I", prn, found, sample, 300.0, 0.0, 45.0, 150.0, 137.0, log10_p, 1e-7)


def test_the_alarm_fires_where_the_search_does():
    plan, recording = recorded()
    log, _ = searched(plan, recording, AcquisitionConfig(second_peak_every_s=0.0))
    for log10_p, found in ((-6.99, False), (-7.01, True)):
        peaks = tuple(peak(27, k * 1_000_000, p, found) for k, p in ((1, -1.0), (2, log10_p)))
        verdict = detect(dataclasses.replace(log, second_peaks=peaks))
        assert verdict.spoofed == found
