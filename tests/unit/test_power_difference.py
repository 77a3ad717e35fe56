"""Power of one band over the other: its false alarms, a weak spoofer, and what must stay silent."""

import dataclasses

import numpy as np
import pytest

from sdr_spoof import detectors
from sdr_spoof.correlator_level import simulate
from sdr_spoof.detectors import DetectionConfig, power_difference, windows
from sdr_spoof.scenario import Scenario
from sdr_spoof.verdict import detect

CONFIG = DetectionConfig(detectors=("power_difference",), false_alarms_per_hour=1.8)


def log_of(duration_s, seed, cn0_dbhz=45.0, attack=()):
    """One satellite in both bands, at correlator level."""
    recording = {
        "duration_s": duration_s,
        "sample_rate_hz": 25e6,
        "lo_hz": 1568.259e6,
        "sample_format": "ci8",
        "bandwidth_hz": 22e6,
    }
    satellite = {"prn": 27, "cn0_dbhz": cn0_dbhz, "range_rate_m_s": 96.1, "delay_ms": 74.263}
    values = {"recording": recording, "satellite": [satellite], "attack": list(attack)}
    return simulate(Scenario.model_validate(values), seed=seed)


def spoofer(signals, phase_cycles):
    """10 dB below the satellite, from 14 s on."""
    return {
        "prn": 27,
        "signals": signals,
        "start_s": 14.0,
        "power_start_db": -30.0,
        "power_db": -10.0,
        "power_ramp_s": 0.1,
        "carrier_phase_cycles": phase_cycles,
    }


def series_of(log, config=CONFIG):
    return list(detectors.find(power_difference.NAME).statistics(log, config))


def with_gain(log, gain_db, signals):
    """The log with the samples of some signals multiplied at each time."""
    tracks = []
    for track in log.signals:
        gain = 10 ** (gain_db(track.time_s) / 20) if track.signal in signals else 1.0
        column = np.reshape(gain, (-1, 1))
        tracks.append(
            dataclasses.replace(
                track,
                taps=(track.taps * column).astype(np.complex64),
                noise_power=track.noise_power * np.ravel(gain) ** 2,
            )
        )
    return dataclasses.replace(log, signals=tuple(tracks))


@pytest.mark.parametrize("cn0_dbhz", [35.0, 45.0])
def test_the_rate_of_false_alarms_is_the_stated_one(cn0_dbhz):
    # Without allowances: 600 an hour for ten minutes; clumps are a longest window apart.
    config = DetectionConfig(
        false_alarms_per_hour=600.0,
        power_difference_wander_db=0.0,
        power_difference_drift_db_s=0.0,
        power_difference_windows_s=(0.6, 1.0, 2.0),
    )
    (series,) = series_of(log_of(600.0, 3, cn0_dbhz), config)
    at = series.time_s[np.abs(series.value) > series.threshold(1e-6)]
    found = 1 + np.count_nonzero(np.diff(at) > 2.0)
    # The windows overlap, so that the sum of their rates is a bound.
    assert 0.1 * 100 < found < 100 + 4 * np.sqrt(100)


@pytest.mark.parametrize("signals", [["B1C"], ["B1I"]])
@pytest.mark.parametrize("phase_cycles", [0.0, 0.5])
def test_a_weak_spoofer_that_turns_nothing_is_found(signals, phase_cycles):
    (satellite,) = detect(
        log_of(17.0, 1, attack=[spoofer(signals, phase_cycles)]), CONFIG
    ).satellites
    (alarm,) = satellite.alarms
    assert (satellite.verdict, alarm.band) == ("suspect", None)
    assert 14.0 < alarm.alarm_s < 16.0
    assert alarm.onset_s == pytest.approx(14.0, abs=0.4)


def test_what_changes_in_both_bands_alike_is_silent():
    log = log_of(30.0, 2)

    def fade(time_s):
        return np.where((time_s > 15.0) & (time_s < 20.0), -8.0, 0.0)

    assert not detect(with_gain(log, fade, {"B1I", "B1CP"}), CONFIG).suspect
    assert detect(with_gain(log, fade, {"B1I"}), CONFIG).suspect


def test_a_change_within_the_allowed_band_is_silent():
    log = with_gain(log_of(30.0, 2), lambda t: np.where(t > 15.0, 0.8, 0.0), {"B1I"})
    assert not detect(log, CONFIG).suspect
    strict = CONFIG.model_copy(update={"power_difference_wander_db": 0.2})
    assert detect(log, strict).suspect


def test_sections_give_the_tests_of_the_whole(monkeypatch):
    log = log_of(60.0, 4)
    (whole,) = series_of(log)
    monkeypatch.setattr(windows, "SECTION_EPOCHS", 2500)
    parts = series_of(log)
    assert len(parts) == 3
    np.testing.assert_array_equal(np.concatenate([p.time_s for p in parts]), whole.time_s)
    value = np.concatenate([p.value for p in parts])
    np.testing.assert_allclose(value, whole.value, atol=1e-6)


def test_a_satellite_without_the_tracks_of_its_signals_is_not_tested():
    log = log_of(10.0, 5)
    assert series_of(dataclasses.replace(log, signals=log.signals[:1])) == []
