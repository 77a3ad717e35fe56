"""What `info` says of recordings made to show it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sdr_spoof.info import RecordingInfo, inspect
from sdr_spoof.info_figure import figure_png
from sdr_spoof.sources import RecordingFormat, open_recording

RATE_HZ = 4e6
COUNT = 1 << 18


def inspected(path: Path, values: np.ndarray, name: str = "ci8") -> RecordingInfo:
    values.tofile(path / "a.bin")
    fmt = RecordingFormat(sample_format=name, sample_rate_hz=RATE_HZ, lo_hz=1575.42e6)
    return inspect(open_recording(path / "a.bin", fmt))


def noise(rms: float, count: int = COUNT) -> np.ndarray:
    return np.random.default_rng(3).normal(0, rms, (count, 2))


def as_int8(values: np.ndarray) -> np.ndarray:
    return np.clip(np.rint(values), -128, 127).astype(np.int8)


def test_clean_noise_has_no_warnings(tmp_path: Path) -> None:
    info = inspected(tmp_path, as_int8(noise(20)))
    assert info.warnings == ()
    assert info.sample_count == info.examined_samples == COUNT
    assert info.levels.rms == pytest.approx(20 * np.sqrt(2), rel=0.01)
    assert info.levels.counts.sum() == 2 * COUNT
    assert info.levels.iq_gain_db == pytest.approx(0, abs=0.1)
    assert info.levels.iq_phase_deg == pytest.approx(0, abs=0.5)
    # Power density of noise of variance 800 over 4 MHz, flat.
    assert info.spectrum.density_db.mean() == pytest.approx(10 * np.log10(800 / 4e6), abs=0.2)
    assert set(info.signals) == {"L1CA", "B1CD", "B1CP"}
    assert "outside" in info.misfits["B1I"]


def test_tone_is_where_it_is(tmp_path: Path) -> None:
    time_s = np.arange(COUNT) / RATE_HZ
    tone = 30 * np.exp(2j * np.pi * -0.7e6 * time_s)
    info = inspected(tmp_path, as_int8(noise(10) + np.column_stack([tone.real, tone.imag])))
    peak = info.spectrum.frequency_hz[info.spectrum.density_db.argmax()]
    assert peak == pytest.approx(-0.7e6, abs=RATE_HZ / 4096)


def test_real_spectrum_is_one_sided(tmp_path: Path) -> None:
    info = inspected(tmp_path, as_int8(noise(20)), "ri8")
    assert info.spectrum.frequency_hz[[0, -1]].tolist() == [0, RATE_HZ / 2]
    assert info.levels.iq_gain_db is None
    # One-sided: the same power in half the band.
    assert info.spectrum.density_db[5:].mean() == pytest.approx(10 * np.log10(400 / 2e6), abs=0.2)


def test_imbalance_and_offset(tmp_path: Path) -> None:
    i, q = noise(20).T
    skew = np.radians(10)
    q = 1.5 * (q * np.cos(skew) + i * np.sin(skew)) + 8
    info = inspected(tmp_path, as_int8(np.column_stack([i, q])))
    assert info.levels.iq_gain_db == pytest.approx(20 * np.log10(1.5), abs=0.1)
    assert info.levels.iq_phase_deg == pytest.approx(10, abs=0.5)
    text = " ".join(info.warnings)
    assert "gain imbalance of 3.5 dB" in text
    assert "quadrature error of" in text
    assert "DC offset" in text


def test_clipping_and_dead_sections(tmp_path: Path) -> None:
    values = as_int8(noise(100))
    values[-(1 << 17) :] = 0
    info = inspected(tmp_path, values)
    text = " ".join(info.warnings)
    assert "1 of 2 examined sections are constant" in text
    assert "% of the values are clipped" in text
    assert info.levels.longest_constant_s == pytest.approx((1 << 17) / RATE_HZ)


def test_lost_samples(tmp_path: Path) -> None:
    values = as_int8(noise(20))
    values[1000:2000] = 7
    info = inspected(tmp_path, values)
    assert any("constant stretch of 250.0 us" in w for w in info.warnings)


def test_small_floats_are_scaled(tmp_path: Path) -> None:
    info = inspected(tmp_path, noise(0.1).astype(np.float32), "cf32")
    assert info.warnings == ()
    # rms of I and Q together, each scaled to 30 over the start of the file
    assert info.levels.rms == pytest.approx(30 * 2**0.5, rel=0.01)


def test_two_bits(tmp_path: Path) -> None:
    values = np.random.default_rng(2).integers(0, 256, COUNT, dtype=np.uint8)
    info = inspected(tmp_path, values, "r2")
    assert info.levels.distinct == 4
    assert np.isnan(info.levels.clipped_share)
    assert info.sample_count == 4 * COUNT
    assert info.warnings == ("no known signal fits: check lo_hz and sample rate",)


def test_short_recording_and_figure(tmp_path: Path) -> None:
    info = inspected(tmp_path, as_int8(noise(20, 100)))
    assert info.examined_samples == 100
    png = figure_png(info)
    assert png.startswith(b"\x89PNG")
    assert png == figure_png(info)
