"""The noise floor of a band: its law over channels, what raises it, and what must not."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.signal import lfilter
from simulated_taps import quality_log, quality_track

from sdr_spoof import simulate
from sdr_spoof.detectors import DetectionConfig, find, noise_floor
from sdr_spoof.detectors.noise_floor import QUANTITY, ChannelBins
from sdr_spoof.report import words
from sdr_spoof.scenario import Scenario
from sdr_spoof.verdict import detect

POWER = DetectionConfig(detectors=("power",))
PRNS = (19, 23, 27, 32)
TIME = (np.arange(6000) + 0.5) * 0.01


def changed(prn, noise_db, power_db, **more):
    """A track whose noise and prompt power change over time."""
    track = quality_track(prn=prn, cn0_dbhz=45.0, **more)
    rng = np.random.default_rng(prn)
    seen = rng.gamma(20.0, 1 / 20.0, TIME.size)  # of 2000 slices, uncorrelated: quieter in means
    return dataclasses.replace(
        track,
        noise_power=track.noise_power * 10 ** (noise_db / 10) * (0.9 + 0.1 * seen),
        taps=(track.taps * 10 ** (power_db / 20)[:, None]).astype(np.complex64),
    )


def floor_alarms(noise_db, power_db, prns=PRNS):
    log = quality_log(*(changed(prn, noise_db, power_db) for prn in prns))
    satellites = detect(log, POWER).satellites
    return [[a for a in s.alarms if a.quantity == QUANTITY] for s in satellites]


def step(size_db):
    return np.where(TIME > 40.0, size_db, 0.0)


def test_interference_is_seen_by_all_and_dated():
    for alarms in floor_alarms(step(0.6), step(0.0)):
        (alarm,) = alarms
        assert 39.0 < alarm.onset_s < 41.5
        assert 40.0 < alarm.alarm_s < 46.0


@pytest.mark.parametrize(
    ("noise_db", "power_db"),
    [(0.6, 0.6), (-0.6, -0.6), (0.6, -3.0), (0.0, 3.0), (-3.0, 0.0), (0.1, 0.0)],
    ids=["gain up", "gain down", "roof", "stronger", "jammer ends", "warmer"],
)
def test_innocent_changes_stay_silent(noise_db, power_db):
    assert not any(floor_alarms(step(noise_db), step(power_db)))


def test_one_satellite_alone_has_no_floor():
    log = quality_log(changed(23, step(3.0), step(0.0)))
    assert QUANTITY not in {s.quantity for s in find("power").statistics(log, POWER)}


def filled(channels, duration_s, seed):
    """Bins of channels whose noise power is averaged as the tracker does."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(round(duration_s / 0.01)) * 0.01
    found = []
    for prn in range(1, channels + 1):
        slices = rng.exponential(size=(time_s.size + 1000) * 10)
        noise = lfilter([1 / 2000], [1, -1 + 1 / 2000], slices)[10000::10]
        channel = ChannelBins(quality_track(prn=prn, duration_s=0.1))
        channel.add(time_s, noise, np.ones(time_s.size))
        found.append(channel)
    return found


@pytest.mark.parametrize("channels", [2, 8])
def test_the_law_of_the_mean_of_independent_taps(channels):
    config = DetectionConfig(power_floor_wander_db=0.0)
    values, sigma = [], 0.0
    for seed in range(8):
        floor = noise_floor._floor(filled(channels, 250.0, seed), config)
        tested = np.flatnonzero(floor.took_part[0])[:: round(5.0 / noise_floor.BIN_S)]
        values.append(floor.value[tested])
        sigma = float(floor.thermal[tested[0]])
    value = np.concatenate(values)
    # Rises only: falls are given as 0. Half of a Gaussian has half its mean square.
    ratio = 2.0 * np.mean(value**2) / sigma**2
    spread = 4.0 * np.sqrt(5.0 / value.size)
    assert 0.5 < ratio < 1.0 + spread
    for share in (0.1, 0.02):
        alarms = np.mean(value > sigma * {0.1: 1.2816, 0.02: 2.0537}[share])
        assert alarms < share + 4.0 * np.sqrt(share / value.size)


def test_bins_filled_in_pieces_are_those_filled_at_once():
    track = quality_track(duration_s=0.1)
    time_s, noise = np.arange(1000) * 0.01, np.linspace(1.0, 2.0, 1000)
    whole, pieces = ChannelBins(track), ChannelBins(track)
    whole.add(time_s, noise, noise)
    for part in np.array_split(np.arange(1000), 7):
        pieces.add(time_s[part], noise[part], noise[part])
    np.testing.assert_allclose(pieces.means(30), whole.means(30))
    assert np.isnan(whole.means(30)[:, 20:]).all()


def asynchronous(prns):
    return Scenario.model_validate(
        {
            "recording": {
                "duration_s": 50.0,
                "sample_rate_hz": 25e6,
                "lo_hz": 1568.259e6,
                "sample_format": "ci8",
                "bandwidth_hz": 22e6,
            },
            "satellite": [
                {"prn": prn, "range_rate_m_s": 80.0 * k, "delay_ms": 70.3 + 1.7 * k}
                for k, prn in enumerate(PRNS)
            ],
            "attack": [
                {"kind": "asynchronous", "prns": prns, "signals": ["B1I", "B1C"], "start_s": 30.0}
            ]
            if prns
            else [],
        }
    )


@pytest.mark.parametrize("prns", [[27], [27, 33, 34, 35]])
def test_overpowered_asynchronous_signals_are_suspect(prns):
    log = simulate(asynchronous(prns))
    log = dataclasses.replace(log, signals=tuple(s for s in log.signals if s.prn in PRNS))
    verdict = detect(dataclasses.replace(log, combos=()), POWER)
    assert not verdict.spoofed
    for satellite in verdict.satellites:
        assert satellite.verdict == "suspect"
        assert satellite.onset_s > 29.0
        assert "rose for all satellites alike" in satellite.reason
        assert "interference, or a second set of signals" in words.satellite_sentence(satellite)


def test_a_quiet_sky_is_clean():
    verdict = detect(simulate(asynchronous([])))
    assert [s.verdict for s in verdict.satellites] == ["clean"] * 4
