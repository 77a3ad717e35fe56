"""Automatic gain control: the first-order law in the samples, the truth, the log, the detectors."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof.correlator_level import simulate
from sdr_spoof.detectors import DetectionConfig, power
from sdr_spoof.detectors.noise_floor import QUANTITY as FLOOR
from sdr_spoof.errors import RecordingError
from sdr_spoof.gain import GainLog, gain_text, read_gain
from sdr_spoof.scenario import Scenario, open_synthesizer, synthesize, truth_path
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sources import RecordingFormat, open_recording
from sdr_spoof.verdict import detect

RATE_HZ, LO_HZ, STEP_S, RISE_DB, CONSTANT_S = 4e6, 1561.098e6, 0.05, 10.0, 0.02
POWER = DetectionConfig(detectors=("power",))


def stepped(sample_format="ci16", agc=True, rise_db=RISE_DB, duration_s=0.2, **more) -> Scenario:
    """Noise that rises by some dB at once."""
    points = [{"time_s": STEP_S, "rise_db": 0.0}, {"time_s": STEP_S, "rise_db": rise_db}]
    control = {"time_constant_s": CONSTANT_S} if agc is True else agc or None
    plan = {
        "duration_s": duration_s,
        "sample_rate_hz": RATE_HZ,
        "lo_hz": LO_HZ,
        "sample_format": sample_format,
        "noise": points,
        "agc": control,
    }
    satellite = {"prn": 19, "signals": ["B1I"], "cn0_dbhz": 45.0}
    return Scenario.model_validate({"recording": plan | more, "satellite": [satellite]})


def power_db(scenario: Scenario, step_s=0.001):
    """Power of the samples in steps, over that of the nominal noise."""
    raw = open_synthesizer(scenario, threads=1).generate(0, scenario.recording.sample_count)
    values = raw.view(np.int16).astype(np.float64) / 256.0
    steps = np.mean(values.reshape(-1, round(2 * step_s * RATE_HZ)) ** 2, axis=1)
    return 10 * np.log10(steps)


def test_a_step_of_power_is_followed_by_the_first_order_law():
    found = power_db(stepped())
    time_s = (np.arange(found.size) + 0.5) * 1e-3
    since_s = np.floor((time_s - STEP_S) / 1e-3 + 0.1) * 1e-3  # the gain is constant within a step
    expected = np.where(time_s > STEP_S, RISE_DB * np.exp(-since_s / CONSTANT_S), 0.0)
    # 8000 values in each step; the noise rises with a segment of the synthesis, 4 ms long.
    apart = np.abs(time_s - STEP_S) > 0.005
    assert np.abs(found - expected)[apart].max() < 4.5 * 4.343 * np.sqrt(2 / 8000)
    assert power_db(stepped(agc=False))[-1] == pytest.approx(RISE_DB, abs=0.3)


def test_without_a_change_of_power_an_agc_changes_next_to_nothing():
    quiet = stepped(rise_db=0.0)
    fixed = stepped(rise_db=0.0, agc=False)
    a, b = (
        open_synthesizer(s, threads=1).generate(0, 100_000).view(np.int16) for s in (quiet, fixed)
    )
    # 45 dB-Hz in 4 MHz are 0.034 dB, which the control takes back.
    assert np.std(a) / np.std(b) == pytest.approx(10 ** (-0.0342 / 20), abs=2e-4)


def test_the_files_tell_the_gain(tmp_path: Path):
    meta = synthesize(stepped(), tmp_path / "x", threads=1)
    told = json.loads(truth_path(meta).read_text())
    end = told["front_end"]
    assert end["noise_db"][0] == 0.0
    assert end["noise_db"][-1] == RISE_DB
    assert end["gain_db"][0] == pytest.approx(-0.034, abs=0.001)
    assert end["gain_db"][1] == pytest.approx(-9.2, abs=0.2)  # 0.1 s, 2.5 time constants
    assert end["input_db"][-1] == pytest.approx(10.0, abs=0.01)
    recording = open_recording(meta)
    assert recording.format.gain_file == "x.agc.csv"
    assert recording.gain is not None
    at = np.asarray(told["time_s"])
    ratio = 10 * np.log10(recording.gain.power(at))
    assert np.abs(ratio - end["gain_db"]).max() < 0.1
    plain = json.loads(truth_path(synthesize(quiet(), tmp_path / "y", threads=1)).read_text())
    assert "front_end" not in plain


def quiet() -> Scenario:
    return stepped(agc=False, noise=[], duration_s=0.01)


def test_a_two_bit_recording_names_its_gain_too(tmp_path: Path):
    meta = synthesize(stepped("c2", duration_s=0.06), tmp_path / "x", threads=1)
    gain = open_recording(meta).gain
    assert gain is not None
    assert gain.gain_db.min() < -3.0


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"agc": {"time_constant_s": 0.0}}, "time_constant_s"),
        ({"agc": {"min_gain_db": 5.0, "max_gain_db": 1.0}}, "exchange"),
        ({"noise": [{"time_s": 1.0, "rise_db": 0}, {"time_s": 0.0, "rise_db": 0}]}, "order"),
    ],
)
def test_settings_that_make_no_sense_are_named(change, word):
    with pytest.raises(ValueError, match=word):
        stepped(**change)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "columns"),
        ("time_s,gain\n0,1\n", "columns"),
        ("time_s,gain_db\n", "no rows"),
        ("time_s,gain_db\n0,1\n0,2\n", "line 3: times must ascend"),
        ("time_s,gain_db\n0,1\n# a gap\n1;2\n", "line 4"),
        ("time_s,gain_db\n0,nan\n", "line 2"),
    ],
)
def test_a_damaged_log_is_named_by_its_line(tmp_path: Path, text, word):
    (tmp_path / "x.agc.csv").write_text(text)
    with pytest.raises(RecordingError, match=word):
        read_gain(tmp_path / "x.agc.csv")


def test_a_log_that_is_missing_is_named_with_what_to_do(tmp_path: Path):
    meta = synthesize(stepped(duration_s=0.01), tmp_path / "x", threads=1)
    (tmp_path / "x.agc.csv").unlink()
    with pytest.raises(RecordingError, match=r"x\.agc\.csv.*restore it"):
        open_recording(meta)


def test_a_log_comes_back(tmp_path: Path):
    log = GainLog(np.array([0.0, 1.5, 2.0]), np.array([0.0, -3.25, 1.0]))
    (tmp_path / "x.agc.csv").write_text("# by hand\n" + gain_text(log))
    again = read_gain(tmp_path / "x.agc.csv")
    assert np.array_equal(again.time_s, log.time_s)
    assert np.array_equal(again.gain_db, log.gain_db)


def sky(*, agc: bool, noise=(), attack=(), duration_s=60.0) -> Scenario:
    """Four satellites."""
    satellites = [{"prn": p, "signals": ["B1I"], "cn0_dbhz": 45.0} for p in (19, 20, 21, 22)]
    plan = {
        "duration_s": duration_s,
        "sample_rate_hz": RATE_HZ,
        "lo_hz": LO_HZ,
        "sample_format": "ci8",
        "agc": {} if agc else None,
        "noise": [{"time_s": t, "rise_db": r} for t, r in noise],
    }
    return Scenario.model_validate(
        {"recording": plan, "satellite": satellites, "attack": list(attack)}
    )


def alarms(log):
    """Quantities that alarmed, of any satellite."""
    return {a.quantity for s in detect(log, POWER).satellites for a in s.alarms}


def blind(log):
    """The same log, where nobody wrote the gain down."""
    return log.__class__(**{**vars(log), "gain": None})


def test_what_detectors_see_of_interference(tmp_path: Path):
    rise = [(30.0, 0.0), (30.5, 6.0)]
    fixed, agc = (simulate(sky(agc=on, noise=rise)) for on in (False, True))
    assert alarms(fixed) == {FLOOR}
    assert alarms(agc) == {FLOOR}
    assert alarms(blind(agc)) == set()
    write_result(tmp_path / "x.h5", Result("x", plan_format(), {}, log=agc))
    again = read_result(tmp_path / "x.h5").log
    assert again is not None
    assert again.gain is not None
    assert np.array_equal(again.gain.gain_db, agc.gain.gain_db)


def plan_format():
    return RecordingFormat(sample_format="ci8", sample_rate_hz=RATE_HZ, lo_hz=LO_HZ)


def test_what_detectors_see_of_a_spoofer_that_is_too_strong():
    # 15 dB over every satellite: 60 dB-Hz each, which in 4 MHz is 3 dB over the noise in all.
    attack = {
        "prns": [19, 20, 21, 22],
        "signals": ["B1I"],
        "start_s": 30.0,
        "power_start_db": -20.0,
        "power_db": 15.0,
        "power_ramp_s": 2.0,
    }
    fixed, agc = (simulate(sky(agc=on, attack=[attack])) for on in (False, True))
    assert {power.CN0, power.AGAINST} <= alarms(fixed)
    assert alarms(agc) == alarms(fixed)
    assert {power.CN0, power.AGAINST} <= alarms(blind(agc))
    assert agc.gain.gain_db[-1] < -1.0


def test_the_end_of_short_interference_is_no_rise_of_power():
    # Within the reference's memory; the gain comes back faster than the noise's mean.
    rise = [(30.0, 0.0), (30.0, 20.0), (36.0, 20.0), (36.0, 0.0)]
    log = simulate(sky(agc=True, noise=rise))
    assert not {power.CN0, power.AGAINST} & alarms(log)


def test_a_transmitter_close_by_shows_in_the_gain_or_not_at_all():
    near = {"kind": "asynchronous", "prns": [30], "signals": ["B1I"], "start_s": 30.0}
    attack = near | {"cn0_dbhz": 75.0}
    fixed, agc = (simulate(sky(agc=on, attack=[attack])) for on in (False, True))
    assert FLOOR in alarms(fixed)
    assert FLOOR in alarms(agc)
    assert alarms(blind(agc)) == set()
    assert agc.gain.gain_db[-1] == pytest.approx(-9.5, abs=0.1)  # 75 dB-Hz in 4 MHz


@pytest.mark.parametrize("sample_format", ["ci16", "ri16"])
@pytest.mark.parametrize("bandwidth_hz", [None, 2.5e6])
def test_signals_count_with_the_power_that_the_filter_leaves(sample_format, bandwidth_hz):
    real = sample_format[0] == "r"
    plan = {
        "sample_rate_hz": 8e6,
        "lo_hz": LO_HZ - 2e6 if real else LO_HZ,
        "noise": [],
        "bandwidth_hz": bandwidth_hz,
        "centre_hz": bandwidth_hz and LO_HZ,
    }
    quiet_ = stepped(sample_format, duration_s=0.1, **plan)
    strong = quiet_.model_dump()
    strong["satellite"][0]["cn0_dbhz"] = 85.0
    made = Scenario.model_validate(strong)
    raw = open_synthesizer(made, threads=1).generate(0, made.recording.sample_count)
    level_db = 20 * np.log10(np.std(raw.view(np.int16).astype(np.float64)) / 256.0)
    assert abs(level_db) < 0.1  # a signal 16 dB over the noise is kept at the noise's level
