"""Emitters with a range and given symbols, from Python."""

import numpy as np
import pytest
from correlation import FS_HZ, LO_HZ, iq, prompt

from sdr_spoof import _core

C = 299_792_458.0
_TIMES = np.arange(-5, 200) * 0.1


def _range(t: np.ndarray) -> np.ndarray:
    return np.asarray(3.6e7 - 431.0 * t + 3.0 * np.cos(1.5 * t))


def _rate(t: np.ndarray) -> np.ndarray:
    return np.asarray(-431.0 - 4.5 * np.sin(1.5 * t))


def _emitter(signal: str = "B1I", prn: int = 27, **more: object) -> _core.Emitter:
    spline = _core.Spline(_TIMES, _range(_TIMES), _rate(_TIMES))
    return _core.Emitter(signal, prn, 70.0, **({"range_m": spline, "delay_s": -6.0} | more))  # type: ignore[arg-type]


def test_a_spline_is_its_curve() -> None:
    t = np.random.default_rng(1).uniform(0.0, 19.0, 1000)
    spline = _core.Spline(_TIMES, _range(_TIMES), _rate(_TIMES))
    # The fourth derivative is 15 m/s^4: 15 * 0.1^4 / 384.
    assert np.abs(spline.value(t) - _range(t)).max() < 4.1e-6
    assert np.abs(spline.rate(t) - _rate(t)).max() < 2e-4


def test_code_phase_and_doppler_follow_the_range() -> None:
    t = np.linspace(0.0, 19.0, 77)
    e = _emitter("B1CP", 27, phase_cycles=0.25)
    chips = 1.023e6 * (t + 6.0 - _range(t) / C)
    assert e.code_phase_chips(t) == pytest.approx(chips, abs=2e-6)
    per_m = 1575.42e6 / C
    assert e.received_phase_cycles(t) == pytest.approx(0.25 - per_m * _range(t), abs=1e-4)
    assert e.doppler_hz(t) == pytest.approx(-per_m * _rate(t), abs=2e-3)


@pytest.mark.parametrize(("signal", "prn"), [("B1I", 27), ("B1I", 3), ("B1CD", 27), ("L1CA", 5)])
def test_samples_have_range_and_symbols(signal: str, prn: int) -> None:
    symbols = np.random.default_rng(2).choice(np.array([-1, 1], np.int8), 4000)
    e = _emitter(signal, prn, symbols=symbols, first_symbol=2)
    assert e.data_symbols(np.arange(2, 4002)) == pytest.approx(symbols)
    assert e.data_symbols(np.array([1, 4002])) == pytest.approx([1, 1])
    synthesizer = _core.Synthesizer("ci8", FS_HZ, LO_HZ, [e], noise_rms_lsb=16.0, noise=False)
    start, count = 2_000_000, 500_000
    found = prompt(e, start, iq(synthesizer.generate(start, count)))
    expected = 16.0 * np.sqrt(2 * 10 ** (70.0 / 10) / FS_HZ)
    assert found / expected == pytest.approx(1.0, abs=0.01)


def test_mistakes() -> None:
    with pytest.raises(ValueError, match=r"\+1 or -1"):
        _core.Synthesizer(
            "ci8", FS_HZ, LO_HZ, [_emitter(symbols=np.zeros(3, np.int8))], noise_rms_lsb=1.0
        )
    with pytest.raises(ValueError, match="give one of them"):
        _emitter(symbols=np.ones(3, np.int8), data_seed=1)
    with pytest.raises(ValueError, match="must increase"):
        _core.Spline(np.zeros(2), np.zeros(2), np.zeros(2))
    with pytest.raises(ValueError, match="as many"):
        _core.Spline(np.arange(2.0), np.zeros(3), np.zeros(2))
