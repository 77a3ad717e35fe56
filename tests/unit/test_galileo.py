"""Galileo E5a and E5b pilots from the samples of both: found, synchronised, joined as a pair."""

import numpy as np
import pytest

from sdr_spoof import _core
from sdr_spoof.acquisition import AcquisitionConfig, acquire
from sdr_spoof.records import State
from sdr_spoof.sources import open_recording
from sdr_spoof.tracking import track

RATE_HZ, LO_HZ = 61e6, 1191.795e6
PAIR = ("E5AQ", "E5BQ")
CN0_DBHZ = 45.0
DOPPLER_HZ = 1.3e-6
"""Of each carrier, in cycles per cycle."""


def emitters():
    """Both pilots of E11; E5b comes a chip later than E5a, as after an attack on it."""
    delays_s = (0.0712345, 0.0712345 + 1 / 10.23e6)
    carriers_hz = [_core.signal_spec(s)["carrier_hz"] for s in PAIR]
    return {
        s: _core.Emitter(s, 11, CN0_DBHZ, delay_s=d, doppler_hz=DOPPLER_HZ * f, data_seed=1)
        for s, d, f in zip(PAIR, delays_s, carriers_hz, strict=True)
    }


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """1.1 s of it."""
    sent = list(emitters().values())
    synthesizer = _core.Synthesizer("ci8", RATE_HZ, LO_HZ, sent, noise_rms_lsb=16.0, seed=5)
    path = tmp_path_factory.mktemp("galileo") / "e5.bin"
    synthesizer.generate(0, round(1.1 * RATE_HZ)).tofile(path)
    return open_recording(path, {"sample_format": "ci8", "sample_rate_hz": RATE_HZ, "lo_hz": LO_HZ})


@pytest.fixture(scope="module")
def acquired(source):
    return acquire(source, AcquisitionConfig(), prns=[3, 11], threads=1)


@pytest.fixture(scope="module")
def log(source, acquired):
    return track(source, acquired, threads=1)


def test_what_is_searched_by_default(source, noise_file):
    assert source.signals() == list(PAIR)
    beidou = {"sample_format": "ri8", "sample_rate_hz": 120e6, "lo_hz": 1538.259e6}
    assert open_recording(noise_file(**beidou)).signals() == ["B1I", "B1CD", "B1CP", "L1CA"]


def test_both_pilots_are_found(acquired):
    assert [(a.signal, a.prn, a.detected) for a in acquired] == [
        (s, prn, prn == 11) for s in PAIR for prn in (3, 11)
    ]
    for a in acquired[1::2]:
        sent = emitters()[a.signal]
        chips = float(sent.code_phase_chips(np.array([a.code_delay_s]))[0]) / 10230
        assert abs(chips - round(chips)) * 10230 < 0.1
        assert abs(a.doppler_hz - sent.doppler_hz(np.zeros(1))[0]) < 0.15 * a.doppler_bin_hz
        assert abs(a.cn0_dbhz - CN0_DBHZ) < 1.2


def test_both_pilots_synchronise_and_join(log):
    assert [t.signal for t in log.signals] == list(PAIR)
    for t in log.signals:
        assert t.state[-1] == State.COMBO
        # 100 ms of secondary code, of which 50 are enough.
        assert t.time_s[t.state >= State.SYNCED][0] < 0.25
        assert (t.taps[t.state >= State.SYNCED, t.prompt_tap].real > 0).all()
        assert t.cn0_dbhz[-1] == pytest.approx(CN0_DBHZ, abs=0.6)


def test_the_pair_tells_the_code_difference_and_the_same_motion(log):
    (combo,) = log.combos
    assert (combo.lower, combo.upper) == PAIR
    joined = combo.state == State.COMBO
    assert combo.subcarrier_lock[-1] > 0.9
    # A chip late. Code noise of ten epochs is taken to be one value, as the loops smooth it.
    late_chips = 10.23e6 * combo.code_difference_s[joined]
    assert abs(late_chips.mean() - 1.0) < 4 * late_chips.std() / np.sqrt(joined.sum() / 10)
    ratio = 1207.14 / 1176.45
    scaled = combo.phase_upper_cycles[joined] - ratio * combo.phase_lower_cycles[joined]
    rate_hz = np.polyfit(combo.time_s[joined], scaled, 1)[0]
    # Slope of white noise, sigma of an epoch's two phases: sigma sqrt(12 / n) / duration.
    count, duration_s = joined.sum(), np.ptp(combo.time_s[joined])
    sigma = np.sqrt(1 / (10 ** (CN0_DBHZ / 10) * combo.integration_s[-1])) / (2 * np.pi)
    assert abs(rate_hz) < 4 * sigma * np.sqrt(12 / count) / duration_s
