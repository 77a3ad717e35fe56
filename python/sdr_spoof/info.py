"""What a recording looks like: levels, spectrum, sanity, and which signals it can hold.

Only a few sections spread over the file are read, so that large recordings answer at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal as dsp

from . import _core
from .errors import SignalError
from .signals import signal_ids

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .sources import Recording, RecordingFormat

_SECTIONS = 16
_SECTION_SAMPLES = 1 << 17
_BINS = 4096
_HISTOGRAM_BINS = 64
_LIMIT = {"i8": (-128, 127), "i16": (-32768, 32767), "f32": (-32768, 32767), "2": (-3, 3)}


@dataclass(frozen=True)
class Spectrum:
    """Welch estimate over the examined sections."""

    frequency_hz: NDArray[np.float64]
    """Frequency in the file, ascending."""
    density_db: NDArray[np.float64]
    """Power per Hz of the unpacked values, dB."""


@dataclass(frozen=True)
class Levels:
    """Statistics of the sample values (I and Q together unless said otherwise)."""

    edges: NDArray[np.float64]
    counts: NDArray[np.int64]
    """Values between consecutive ``edges``."""
    distinct: int
    bits_used: float
    """log2 of the range of values."""
    rms: float
    dc_share: float
    """|mean| over rms of the samples."""
    clipped_share: float
    """Share of values at the ends of the format's range; NaN for 2-bit samples."""
    longest_constant_s: float
    """Longest stretch of identical samples in one section."""
    iq_gain_db: float | None
    iq_phase_deg: float | None
    """Q against I: gain, and departure from quadrature; None for real samples."""


@dataclass(frozen=True)
class RecordingInfo:
    """Answer of ``sdr-spoof info``."""

    path: str
    format: RecordingFormat
    sample_count: int
    duration_s: float
    examined_samples: int
    signals: tuple[str, ...]
    """Registered signals that fit."""
    misfits: dict[str, str]
    """Signals that do not fit, with the reason."""
    levels: Levels
    spectrum: Spectrum
    warnings: tuple[str, ...]


def inspect(recording: Recording) -> RecordingInfo:
    """Examine a recording."""
    sections = _sections(recording)
    levels = _levels(sections, recording.format)
    misfits = _misfits(recording)
    return RecordingInfo(
        path=str(recording.path),
        format=recording.format,
        sample_count=recording.sample_count,
        duration_s=recording.duration_s,
        examined_samples=sum(s.shape[0] for s in sections),
        signals=tuple(s for s in signal_ids() if s not in misfits),
        misfits=misfits,
        levels=levels,
        spectrum=_spectrum(sections, recording.format),
        warnings=tuple(_warnings(sections, levels, misfits, recording)),
    )


def _sections(recording: Recording) -> list[NDArray[np.int16]]:
    """Values of evenly spread sections, each of shape (samples, 1 or 2)."""
    length = min(_SECTION_SAMPLES, recording.sample_count)
    last = recording.sample_count - length
    count = min(_SECTIONS, recording.sample_count // length)
    # Whole bytes for 2-bit formats: starts are multiples of 4 samples.
    starts = sorted({last * i // max(count - 1, 1) // 4 * 4 for i in range(count)})
    fmt = recording.format
    columns = 2 if fmt.is_complex else 1
    return [
        _core.unpack(
            fmt.sample_format, recording.read_raw(s, length), fmt.float_scale, fmt.conjugate
        ).reshape(-1, columns)
        for s in starts
    ]


def _levels(sections: list[NDArray[np.int16]], format: RecordingFormat) -> Levels:
    values = np.concatenate(sections).astype(np.float64)
    low, high = _LIMIT[format.sample_format[1:]]
    distinct, counts = np.unique(values, return_counts=True)
    edges = _edges(distinct)
    rms = float(np.sqrt(np.mean(np.sum(values**2, axis=1))))
    ends = counts[(distinct <= low) | (distinct >= high)].sum()
    gain_db, phase_deg = _iq_imbalance(values) if format.is_complex else (None, None)
    return Levels(
        edges=edges,
        counts=np.histogram(distinct, edges, weights=counts)[0].astype(np.int64),
        distinct=distinct.size,
        bits_used=float(np.log2(distinct[-1] - distinct[0] + 1)),
        rms=rms,
        dc_share=float(np.linalg.norm(values.mean(axis=0)) / rms) if rms else 0.0,
        clipped_share=float("nan") if high == 3 else float(ends / values.size),
        longest_constant_s=max(map(_longest_constant, sections)) / format.sample_rate_hz,
        iq_gain_db=gain_db,
        iq_phase_deg=phase_deg,
    )


def _edges(distinct: NDArray[np.float64]) -> NDArray[np.float64]:
    """Histogram edges halfway between integers, at most 64 bins of equal width."""
    span = distinct[-1] - distinct[0] + 1
    width = max(1, int(np.ceil(span / _HISTOGRAM_BINS)))
    bins = int(np.ceil(span / width))
    edges: NDArray[np.float64] = distinct[0] - 0.5 + width * np.arange(bins + 1.0)
    return edges


def _longest_constant(section: NDArray[np.int16]) -> int:
    """Samples of the longest run of equal samples."""
    changes = np.flatnonzero(np.any(section[1:] != section[:-1], axis=1)) + 1
    borders = np.concatenate(([0], changes, [section.shape[0]]))
    return int(np.diff(borders).max())


def _iq_imbalance(values: NDArray[np.float64]) -> tuple[float, float]:
    """Gain of Q over I in dB, and departure from quadrature in degrees, from second moments."""
    i, q = (values - values.mean(axis=0)).T
    power_i, power_q = float(i @ i), float(q @ q)
    if power_i == 0 or power_q == 0:
        return float("nan"), float("nan")
    sine = float(i @ q) / np.sqrt(power_i * power_q)
    return 10 * np.log10(power_q / power_i), float(np.degrees(np.arcsin(sine)))


def _spectrum(sections: list[NDArray[np.int16]], format: RecordingFormat) -> Spectrum:
    """Average of the sections' Welch estimates; two-sided for complex samples."""
    bins = min(_BINS, sections[0].shape[0])
    estimates = []
    for section in sections:
        values = section[:, 0] + 1j * section[:, 1] if format.is_complex else section[:, 0] * 1.0
        frequency, density = dsp.welch(
            values,
            format.sample_rate_hz,
            nperseg=bins,
            return_onesided=not format.is_complex,
            detrend=False,
        )
        estimates.append(density)
    mean = np.mean(estimates, axis=0)
    order = np.argsort(frequency)
    floor = np.finfo(np.float64).tiny
    return Spectrum(frequency[order], 10 * np.log10(np.maximum(mean[order], floor)))


def _misfits(recording: Recording) -> dict[str, str]:
    reasons: dict[str, str] = {}
    for signal in signal_ids():
        try:
            recording.check_signal(signal)
        except SignalError as error:
            reasons[signal] = str(error).removeprefix(f"{recording.path}: ")
    return reasons


def _warnings(
    sections: list[NDArray[np.int16]],
    levels: Levels,
    misfits: dict[str, str],
    recording: Recording,
) -> list[str]:
    """What looks wrong, in words."""
    dead = sum(bool((s == s[0]).all()) for s in sections)
    checks = [
        (recording.extra.get("partial") is True, "partial: synthesis was interrupted"),
        (dead > 0, f"{dead} of {len(sections)} examined sections are constant: no signal there"),
        (
            not dead and levels.longest_constant_s * recording.format.sample_rate_hz > 200,
            f"a constant stretch of {levels.longest_constant_s * 1e6:.1f} us: samples were lost",
        ),
        (levels.clipped_share > 0.01, f"{levels.clipped_share:.1%} of the values are clipped"),
        (levels.dc_share > 0.1, f"DC offset of {levels.dc_share:.2f} of the rms"),
        (levels.rms < 0.5, "values are too small: sample_format is wrong"),
        (
            levels.iq_gain_db is not None and abs(levels.iq_gain_db) > 1,
            f"I/Q gain imbalance of {levels.iq_gain_db or 0:.1f} dB",
        ),
        (
            levels.iq_phase_deg is not None and abs(levels.iq_phase_deg) > 5,
            f"I/Q quadrature error of {levels.iq_phase_deg or 0:.1f} degrees",
        ),
        (len(misfits) == len(signal_ids()), "no known signal fits: check lo_hz and sample rate"),
    ]
    return [text for wrong, text in checks if wrong]
