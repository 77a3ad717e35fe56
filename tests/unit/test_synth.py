"""The synthesis as Python sees it; the numbers themselves are tested in rust/core/tests/synth."""

import math

import numpy as np
import pytest
from correlation import FS_HZ, LO_HZ, iq, prompt

from sdr_spoof import _core


def synthesizer(emitters: list[_core.Emitter], **options: object) -> _core.Synthesizer:
    settings = {"noise_rms_lsb": 16.0, "bandwidth_hz": 22e6, "seed": 3, "threads": 1} | options
    return _core.Synthesizer("ci8", FS_HZ, LO_HZ, emitters, **settings)  # type: ignore[arg-type]


def emitter(signal: str = "B1I", prn: int = 27, cn0_dbhz: float = 50.0) -> _core.Emitter:
    return _core.Emitter(signal, prn, cn0_dbhz, delay_s=0.07, doppler_hz=-812.0, data_seed=5)


@pytest.mark.parametrize("signal", ["B1I", "B1CD"])
def test_correlation_finds_amplitude_and_phase(signal: str) -> None:
    """40 ms at 50 dB-Hz: SNR 36 dB, so amplitude and phase have a standard error of 1.1 %."""
    e, start, count = emitter(signal), 1_250_000, 1_000_000
    x = iq(synthesizer([e]).generate(start, count))
    gain = math.sqrt(22 / 25)  # noise of the output is 16 after the filter
    expected = 16 / gain * math.sqrt(2 * 10**5.0 / FS_HZ)
    error = prompt(e, start, x) / expected - 1
    # 4 standard errors, and 1 % for the power that the filter cuts off
    assert abs(error) < 4 * 0.011 + 0.01


def test_noise_has_the_rms_asked_for() -> None:
    x = iq(synthesizer([], bandwidth_hz=None).generate(0, 1_000_000))
    for rail in (x.real, x.imag):
        # quantisation adds 1/12; 4 standard errors of a variance of 10^6 samples
        assert abs(rail.var() / (16.0**2 + 1 / 12) - 1) < 4 * math.sqrt(2e-6)
        assert abs(rail.mean()) < 4 * 16e-3
    assert abs(np.mean(x.real * x.imag)) < 4 * 256e-3


def test_threads_and_cuts_change_nothing() -> None:
    emitters = [emitter(), emitter("B1CP"), emitter("B1CD", 40)]
    whole = synthesizer(emitters).generate(0, 50_000)
    two = synthesizer(emitters, threads=2)
    parts = [two.generate(a, b - a) for a, b in [(0, 1), (1, 7777), (7777, 50_000)]]
    assert np.array_equal(whole, np.concatenate(parts))


def test_a_silent_emitter_has_no_cn0() -> None:
    e = _core.Emitter("B1I", 19, 45.0, power_db=[(0.0, 0.0), (1.0, 10.0)], start_s=0.5, end_s=2.0)
    assert e.cn0_dbhz(np.array([0.4, 0.5, 1.5, 2.0])).tolist() == [-np.inf, 50.0, 55.0, -np.inf]
    assert (e.signal, e.prn) == ("B1I", 19)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: _core.Emitter("B9X", 1, 45.0), "known signals: B1I"),
        (lambda: _core.Emitter("B1I", 1, 45.0, power_db=[(1, 0), (0, 0)]), "must not decrease"),
        (lambda: synthesizer([emitter("B1CD", 3)]), "no PRN 3"),
        (lambda: synthesizer([emitter("B1I", 19, math.nan)]), "cn0_dbhz"),
        (lambda: synthesizer([], bandwidth_hz=30e6), "front-end band"),
        (lambda: synthesizer([], noise_rms_lsb=0.0), "noise_rms_lsb"),
        (lambda: _core.Synthesizer("ci9", 1.0, 0.0, [], noise_rms_lsb=1.0), "ri8, ci8"),
        (lambda: _core.Synthesizer("ri8", 0.0, 0.0, [], noise_rms_lsb=1.0), "sample rate"),
    ],
)
def test_mistakes_are_named(make: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()  # type: ignore[operator]
