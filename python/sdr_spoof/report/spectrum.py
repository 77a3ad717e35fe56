"""Power spectral density of a recording, from a few sections of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from sdr_spoof import _core


class RecordingLike(Protocol):
    """What the report needs of a recording."""

    @property
    def path(self) -> Path:
        """Where it lies."""

    @property
    def format(self) -> Any:
        """Sample format, rate and ``lo_hz``."""

    @property
    def sample_count(self) -> int:
        """Samples in the recording."""

    def read_raw(self, start: int, count: int) -> NDArray[np.uint8]:
        """Raw bytes of whole samples."""


@dataclass(frozen=True)
class Spectrum:
    """Power spectral density over radio frequency; both arrays have N rows."""

    rf_hz: NDArray[np.float64]
    density_db: NDArray[np.float64]
    """dB relative to 1 (sample value)^2 per Hz."""
    averaged_s: float
    """Signal that went into it, in s; at most the length of the recording."""


def estimate_spectrum(
    recording: RecordingLike,
    *,
    sections: int = 64,
    section_samples: int = 1 << 15,
    bins: int = 4096,
) -> Spectrum:
    """Welch estimate (Hann window) from sections spread evenly over the recording."""
    count = min(section_samples, recording.sample_count)
    count -= count % 8  # 2-bit samples come in whole bytes
    last = recording.sample_count - count
    starts = np.unique(np.linspace(0, last, sections).astype(np.int64) // 8 * 8)
    densities = [_section(recording, int(start), count, bins) for start in starts]
    frequency = densities[0][0]
    density = np.mean([d for _, d in densities], axis=0)
    order = np.argsort(frequency)
    tiny = np.finfo(np.float64).tiny
    return Spectrum(
        rf_hz=frequency[order] + recording.format.lo_hz,
        density_db=10.0 * np.log10(np.maximum(density[order], tiny)),
        averaged_s=min(count * len(starts), recording.sample_count)
        / recording.format.sample_rate_hz,
    )


def _section(
    recording: RecordingLike, start: int, count: int, bins: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    form = recording.format
    raw = recording.read_raw(start, count)
    values = _core.unpack(form.sample_format, raw, form.float_scale, form.conjugate)
    samples = values.astype(np.float32)  # single precision: FFTs of many pieces at once are fast
    is_complex = _core.sample_format(form.sample_format)[1]
    return _welch(samples.view(np.complex64) if is_complex else samples, form.sample_rate_hz, bins)


def _welch(
    samples: NDArray[Any], rate_hz: float, bins: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies and power density: Hann windows that overlap by half; real samples one-sided.

    P. Welch, The use of fast Fourier transform for the estimation of power spectra, 1967.
    """
    bins = min(bins, samples.size)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(bins) / bins)
    pieces = np.lib.stride_tricks.sliding_window_view(samples, bins)[:: bins - bins // 2]
    pieces = pieces * window.astype(np.float32)
    two_sided = np.iscomplexobj(samples)
    lines = scipy.fft.fft(pieces, axis=1) if two_sided else scipy.fft.rfft(pieces, axis=1)
    power = np.mean(lines.real**2 + lines.imag**2, axis=0, dtype=np.float64)
    density = np.asarray(power / (rate_hz * np.sum(window**2)))
    if two_sided:
        return scipy.fft.fftfreq(bins, 1.0 / rate_hz), density
    density[1 : (bins + 1) // 2] *= 2.0  # of both signs, but for zero and half the rate
    return scipy.fft.rfftfreq(bins, 1.0 / rate_hz), density
