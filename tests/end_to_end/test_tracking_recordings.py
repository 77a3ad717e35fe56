"""Real recordings: tracking against a third-party receiver's findings.

See vectors/recordings/README.md. The 12 Msps recording has a discontinuity near its end, at which
the code of every satellite jumps at once (shown below by a plain correlation): tracking is judged
up to there.
"""

import csv
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof import _core
from sdr_spoof.acquisition import AcquisitionConfig, acquire
from sdr_spoof.records import State
from sdr_spoof.sources import open_recording
from sdr_spoof.tracking import TrackingConfig, track

VECTORS = Path(__file__).parents[1] / "vectors" / "recordings"
REAL = "L1_20211125_004000_12MHz_I"
IQ = "L1_20211202_084700_4MHz_IQ"
END_S = {REAL: 0.0873, IQ: 0.4995}
"""To the discontinuity, and to the end."""
STRONG_DBHZ = 43.0
CASES = [(n, s) for n in (REAL, IQ) for s in ("L1CA", "B1CP")]


@lru_cache
def table(name, signal):
    with (VECTORS / f"{name}.csv").open() as f:
        return {int(r["prn"]): r for r in csv.DictReader(f) if r["signal"] == signal}


@lru_cache
def tracked(name, signal):
    recording = open_recording(VECTORS / f"{name}.bin")
    prns = [p for p, r in table(name, signal).items() if r["status"] == "certain"]
    found = acquire(recording, AcquisitionConfig(), signals=[signal], prns=prns, threads=2)
    return track(recording, found, TrackingConfig(), threads=2)


def strong(name, signal):
    """(track, rows to judge, line of the table) of every strong satellite."""
    for t in tracked(name, signal).signals:
        line = table(name, signal)[t.prn]
        if float(line["cn0_dbhz"]) >= STRONG_DBHZ:
            yield t, t.time_s + t.integration_s / 2 < END_S[name], line


@pytest.mark.parametrize(("name", "signal"), CASES)
def test_strong_satellites_are_held_to_the_end(name, signal):
    count = 0
    for t, rows, _ in strong(name, signal):
        state, lock = t.state[rows], t.phase_lock[rows]
        assert state[-1] >= State.TRACKING, t.prn
        locked = np.flatnonzero(state >= State.TRACKING)
        assert np.all(np.diff(locked) == 1), f"{t.prn}: lock was lost on the way"
        # Found quickly, kept for the rest, to within a B1C code period of the end.
        assert t.time_s[locked[0]] < 0.2, t.prn
        assert END_S[name] - t.time_s[rows][-1] < 0.0151, t.prn
        assert lock[-1] > 0.8, t.prn
        # Code: the prompt tap is the largest, early and late agree.
        power = (np.abs(t.taps[rows][locked]) ** 2).mean(axis=0)
        early, prompt, late = power[t.prompt_tap - 1 : t.prompt_tap + 2]
        assert prompt == power.max()
        assert abs(early - late) < 0.25 * prompt, t.prn
        count += 1
    assert count >= 5


@pytest.mark.parametrize(("name", "signal"), CASES)
def test_cn0_agrees_with_the_table(name, signal):
    for t, rows, line in strong(name, signal):
        assert t.cn0_dbhz[rows][-1] == pytest.approx(float(line["cn0_dbhz"]), abs=2.5), t.prn


@pytest.mark.parametrize(("name", "signal"), CASES)
def test_doppler_agrees_with_the_table(name, signal):
    for t, rows, line in strong(name, signal):
        tolerance_hz = 30.0 if signal == "L1CA" else 5.0
        keep = rows & (t.state >= State.TRACKING)
        doppler_hz = t.doppler_hz[keep][len(t.doppler_hz[keep]) // 2 :].mean()
        assert doppler_hz == pytest.approx(float(line["doppler_hz"]), abs=tolerance_hz), t.prn


@pytest.mark.parametrize("name", [REAL, IQ])
def test_doppler_of_qzss_agrees_with_its_10_ms_signal(name):
    # The table's L1C Doppler, from 10 ms codes, is several times finer than that of L1 C/A.
    other = table(name, "L1CP")
    common = [(t, r) for t, r, _ in strong(name, "L1CA") if t.prn in other]
    assert common
    for t, rows in common:
        doppler_hz = t.doppler_hz[rows][-40:].mean()
        assert doppler_hz == pytest.approx(float(other[t.prn]["doppler_hz"]), abs=5.0), t.prn


def test_the_12_msps_recording_jumps_near_its_end():
    samples = np.fromfile(VECTORS / f"{REAL}.bin", np.int8).astype(np.float64)
    k = np.arange(12_000)
    for prn in (5, 13, 15, 20):
        doppler_hz = float(table(REAL, "L1CA")[prn]["doppler_hz"])
        chips = _core.code_chips("L1CA", prn).astype(np.float64)
        code = np.fft.fft(chips[(k * 1.023e6 / 12e6).astype(int) % 1023])

        def delay(start, code=code, doppler_hz=doppler_hz):
            mixed = samples[start + k] * np.exp(-2j * np.pi * (3e6 + doppler_hz) * k / 12e6)
            peak = np.abs(np.fft.ifft(np.fft.fft(mixed) * np.conj(code)))
            return (peak.argmax() + start) % 12_000

        before, after = delay(int(0.080 * 12e6)), delay(int(0.092 * 12e6))
        assert (after - before) % 12_000 == pytest.approx(12_000 - 965, abs=2), prn
