"""Acquisition on synthetic recordings of known content."""

import numpy as np
import pytest

from sdr_spoof import _core
from sdr_spoof.acquisition import AcquisitionConfig, acquire
from sdr_spoof.errors import RecordingError, SignalError
from sdr_spoof.sources import open_recording

B1I_HZ, B1C_HZ = 1561.098e6, 1575.42e6


def recording(folder, emitters, *, format="ci8", rate=8e6, lo=B1I_HZ, length_s=0.024, tone=0.0):
    """Emitters in noise of 20 LSB (2-bit: 2), with a tone of that many LSB at 0.35 MHz."""
    noise = 1.0 if format in ("r2", "c2") else 20.0
    synthesizer = _core.Synthesizer(format, rate, lo, emitters, noise_rms_lsb=noise, seed=5)
    raw = synthesizer.generate(0, round(length_s * rate) // 4 * 4)
    if tone:
        turn = np.exp(2j * np.pi * 0.35e6 / rate * np.arange(len(raw) // 2))
        values = raw.view(np.int8) + tone * turn.view(np.float64)
        raw = np.clip(np.rint(values), -128, 127).astype(np.int8).view(np.uint8)
    path = folder / "recording.bin"
    path.write_bytes(raw.tobytes())
    return open_recording(path, {"sample_format": format, "sample_rate_hz": rate, "lo_hz": lo})


def found(acquisitions):
    return {(a.signal, a.prn): a for a in acquisitions if a.detected}


def code_error_chips(acquisition, emitter, rate):
    """Code phase at the estimated start of a code period, less a whole number of periods."""
    spec = _core.signal_spec(emitter.signal)
    time_s = acquisition.sample_index / rate + acquisition.code_delay_s
    phase = emitter.code_phase_chips(np.array([time_s]))[0] / spec["code_length"]
    return (phase - round(phase)) * spec["code_length"]


@pytest.fixture(scope="module")
def dual(tmp_path_factory):
    """Three satellites; the B1C of PRN 30 comes 33 chips later than its B1I would have it."""
    ratio = B1I_HZ / B1C_HZ
    emitters = []
    for prn, doppler_hz, delay_s, late_s in (
        (19, 3211.0, 0.0713, 0.0),
        (30, -2404.0, 0.0789, 33 / 1.023e6),
        (59, 0.0, 0.1243, None),
    ):
        emitters.append(
            _core.Emitter(
                "B1I", prn, 44, delay_s=delay_s, doppler_hz=doppler_hz * ratio, data_seed=prn
            )
        )
        if late_s is not None:
            emitters.append(
                _core.Emitter("B1CP", prn, 44, delay_s=delay_s + late_s, doppler_hz=doppler_hz)
            )
    folder = tmp_path_factory.mktemp("dual")
    return recording(folder, emitters, rate=24e6, lo=1568.259e6, length_s=0.07), emitters


def test_handover_finds_both_signals(dual):
    source, emitters = dual
    result = acquire(source, AcquisitionConfig(), threads=2, signals=["B1CP", "B1I"])
    assert [a.prn for a in result if a.signal == "B1I"] == list(range(1, 64))
    # A geostationary satellite sends no B1C; the other two are handed over.
    assert [a.prn for a in result if a.signal == "B1CP"] == [19, 30]
    hits = found(result)
    assert hits.keys() == {(e.signal, e.prn) for e in emitters}
    for e in emitters:
        a = hits[e.signal, e.prn]
        assert abs(code_error_chips(a, e, 24e6)) < 0.1
        assert abs(a.doppler_hz - e.doppler_hz(np.zeros(1))[0]) < 0.15 * a.doppler_bin_hz
        assert abs(a.cn0_dbhz - 44) < 1.2
        assert a.statistic > a.threshold


def test_result_is_the_same_for_any_number_of_threads(dual):
    source, _ = dual
    one, two = (acquire(source, AcquisitionConfig(), prns=[19, 20, 30], threads=n) for n in (1, 2))
    assert one == two


def test_search_from_any_sample(dual):
    source, emitters = dual
    for start in (1, 100_003):
        result = acquire(
            source, AcquisitionConfig(), signals=["B1I"], prns=[19], start_sample=start, threads=1
        )
        (a,) = result
        assert a.sample_index == start
        assert abs(code_error_chips(a, emitters[0], 24e6)) < 0.1


def test_progress_reaches_the_end(dual):
    calls = []
    acquire(
        dual[0],
        AcquisitionConfig(),
        signals=["B1I", "B1CP"],
        threads=2,
        progress=lambda done, total: calls.append((done, total)),
    )
    done, total = zip(*calls, strict=True)
    assert list(done) == sorted(done)
    assert done[-1] == total[-1]
    assert len(calls) > 8


def test_a_receiver_clock_25_ppm_off_costs_nothing(tmp_path):
    """40 kHz of Doppler move B1C's code by a quarter of a chip in one code period.

    Uncorrected, that is an error of an eighth of a chip.
    """
    emitters = [
        _core.Emitter("B1I", 30, 44, delay_s=0.0802, doppler_hz=40e3 * B1I_HZ / B1C_HZ),
        _core.Emitter("B1CP", 30, 44, delay_s=0.0802, doppler_hz=40e3),
    ]
    source = recording(tmp_path, emitters, rate=24e6, lo=1568.259e6, length_s=0.07)
    for handover in (True, False):
        config = AcquisitionConfig(doppler_max_hz=50e3, handover=handover)
        hits = found(acquire(source, config, signals=["B1I", "B1CP"], prns=[30, 31], threads=2))
        assert hits.keys() == {("B1I", 30), ("B1CP", 30)}
        for e in emitters:
            a = hits[e.signal, e.prn]
            limit = {"B1I": 0.1, "B1CP": 0.05}[e.signal]
            assert abs(code_error_chips(a, e, 24e6)) < limit
            assert abs(a.doppler_hz - e.doppler_hz(np.zeros(1))[0]) < 0.15 * a.doppler_bin_hz
            assert abs(a.cn0_dbhz - 44) < 1.0


@pytest.mark.parametrize(("format", "rate"), [("r2", 16e6), ("ri16", 16.3676e6), ("cf32", 5e6)])
def test_other_formats_and_rates(tmp_path, format, rate):
    lo = B1C_HZ - (0.0 if format.startswith("c") else 4.1e6)
    e = _core.Emitter("L1CA", 7, 46, delay_s=0.0692, doppler_hz=1777.0, data_seed=1)
    source = recording(tmp_path, [e], format=format, rate=rate, lo=lo)
    (a,) = acquire(
        source, AcquisitionConfig(), signals=["L1CA"], prns=[7], start_sample=999, threads=1
    )
    assert a.detected
    assert abs(code_error_chips(a, e, rate)) < 0.1
    assert abs(a.doppler_hz - 1777.0) < 75.0


def test_a_very_strong_signal_makes_no_false_ones_and_hides_no_other(tmp_path):
    strong = _core.Emitter("L1CA", 3, 62, delay_s=0.07, doppler_hz=510.0, data_seed=1)
    weak = _core.Emitter("L1CA", 9, 42, delay_s=0.0713, doppler_hz=-1490.0, data_seed=2)
    source = recording(tmp_path, [strong, weak], rate=5e6, lo=B1C_HZ)
    result = acquire(source, AcquisitionConfig(), signals=["L1CA"], threads=2)
    assert found(result).keys() == {("L1CA", 3), ("L1CA", 9)}


def test_ten_strong_satellites_make_no_false_one(tmp_path):
    rng = np.random.default_rng(11)
    prns = [2, 6, 11, 20, 23, 34, 38, 45, 59, 61]
    emitters = [
        _core.Emitter(
            "B1I",
            prn,
            52,
            delay_s=float(rng.uniform(0.06, 0.09)),
            doppler_hz=float(rng.uniform(-4500, 4500)),
            data_seed=prn,
        )
        for prn in prns
    ]
    source = recording(tmp_path, emitters)
    result = acquire(source, AcquisitionConfig(), signals=["B1I"], threads=2)
    assert sorted(prn for _, prn in found(result)) == prns


def test_a_tone_is_no_satellite(tmp_path):
    e = _core.Emitter("L1CA", 3, 45, delay_s=0.07, doppler_hz=510.0, data_seed=1)
    source = recording(tmp_path, [e], rate=5e6, lo=B1C_HZ, tone=20.0)
    result = acquire(source, AcquisitionConfig(), signals=["L1CA"], threads=2)
    assert found(result).keys() == {("L1CA", 3)}


def test_a_short_recording_is_searched_with_fewer_sums(tmp_path):
    e = _core.Emitter("B1I", 21, 50, delay_s=0.07, data_seed=1)
    source = recording(tmp_path, [e], length_s=0.006)
    (a,) = acquire(source, AcquisitionConfig(), signals=["B1I"], prns=[21], threads=1)
    assert a.detected
    with pytest.raises(RecordingError, match="too short: B1I needs 2 ms"):
        acquire(source, AcquisitionConfig(), signals=["B1I"], start_sample=40_000)


def test_what_cannot_be_searched_is_refused(tmp_path):
    source = recording(tmp_path, [], length_s=0.004)
    with pytest.raises(SignalError, match="unknown signal 'B1Q'"):
        acquire(source, AcquisitionConfig(), signals=["B1Q"])
    with pytest.raises(SignalError, match="outside its band"):
        acquire(source, AcquisitionConfig(), signals=["L1CA"])
    with pytest.raises(SignalError, match=r"B1I: none of the PRNs asked for \(64\)"):
        acquire(source, AcquisitionConfig(), signals=["B1I"], prns=[64])
    with pytest.raises(RecordingError, match="start_sample is -4; the first"):
        acquire(source, AcquisitionConfig(), signals=["B1I"], start_sample=-4)
    (tmp_path / "silence.bin").write_bytes(bytes(64_000))
    silence = open_recording(tmp_path / "silence.bin", source.format)
    with pytest.raises(RecordingError, match="all zero"):
        acquire(silence, AcquisitionConfig(), signals=["B1I"])
