"""A recording on disk, read piece by piece, never whole.

Plain reads: a file mapped into memory would be as fast, but its pages count as the process's
memory, and where the disk fails, a map ends the process instead of raising an error.
"""

from __future__ import annotations

import os
import weakref
from typing import TYPE_CHECKING

import numpy as np

from sdr_spoof.errors import RecordingError, SignalError
from sdr_spoof.gain import read_gain
from sdr_spoof.raw_files import read_all
from sdr_spoof.signals import signal_ids, signal_spec

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

    from numpy.typing import NDArray

    from sdr_spoof.gain import GainLog

    from .model import RecordingFormat


class Recording:
    """Samples of one file.

    Attributes:
        path: the data file.
        format: how to read it.
        sample_count: whole samples in the file.
        extra: what its metadata says beyond the format (own namespace keys of SigMF).
        start: UTC of the first sample, None where the metadata does not tell it.
        gain: gain of the recorder, None for a constant or unknown one.
    """

    def __init__(
        self,
        path: Path,
        format: RecordingFormat,
        extra: dict[str, object] | None = None,
        start: datetime | None = None,
    ) -> None:
        """Open the file.

        Raises:
            RecordingError: missing, not a file, empty, or not a whole number of samples; a gain
                log that is damaged.
        """
        self.path = path
        self.format = format
        self.extra = dict(extra or {})
        self.start = start
        self._bits = format.bits_per_sample
        check_file(path)
        self.gain: GainLog | None = (
            None if format.gain_file is None else read_gain(path.parent / format.gain_file)
        )
        size = path.stat().st_size - format.offset_bytes
        _check_size(path, size, format)
        self.sample_count = size * 8 // self._bits
        self._file = path.open("rb", buffering=0)
        weakref.finalize(self, self._file.close)
        if hasattr(os, "posix_fadvise"):
            os.posix_fadvise(self._file.fileno(), 0, 0, os.POSIX_FADV_SEQUENTIAL)

    @property
    def duration_s(self) -> float:
        """Length in seconds."""
        return self.sample_count / self.format.sample_rate_hz

    def read_raw(self, start: int, count: int) -> NDArray[np.uint8]:
        """Bytes of ``count`` samples from sample ``start``, shape (bytes,).

        Fewer at the end of the file, none beyond it.

        Raises:
            RecordingError: the disk fails, or the file has become shorter.
            ValueError: if ``start`` is negative or not on a byte (2-bit formats), or ``count``
                is negative.
        """
        if start < 0 or count < 0:
            raise ValueError(f"start and count must not be negative, got {start} and {count}")
        if start * self._bits % 8:
            raise ValueError(f"sample {start} of {self.format.sample_format} starts inside a byte")
        stop = min(start + count, self.sample_count)
        first = start * self._bits // 8
        raw = np.empty(max(0, -(-stop * self._bits // 8) - first), np.uint8)
        try:
            self._file.seek(self.format.offset_bytes + first)
            read_all(self._file, raw.data)
        except OSError as error:
            raise RecordingError(f"{self.path}: cannot be read: {error.strerror}") from error
        return raw

    def check_signal(self, signal: str) -> None:
        """Check that the recording can hold a signal.

        The usable band is |file frequency| in [0, fs/2] for real samples and [-fs/2, fs/2] for
        complex ones; it must hold the carrier +- the signal's ``min_half_bandwidth_hz``.

        Raises:
            SignalError: unknown signal, sample rate too low, or band outside the recording.
        """
        spec = signal_spec(signal)
        half, fs = spec.min_half_bandwidth_hz, self.format.sample_rate_hz
        least_hz = (2 if self.format.is_complex else 4) * half
        if fs < least_hz:
            raise SignalError(
                f"{self.path}: sample rate {fs / 1e6:g} Msps is too low for {signal}, which needs "
                f"at least {least_hz / 1e6:g} Msps; use a faster recording or another signal"
            )
        centre = spec.carrier_hz - self.format.lo_hz
        offset = centre if self.format.is_complex else abs(centre)
        low = -fs / 2 if self.format.is_complex else 0.0
        if offset - half < low or offset + half > fs / 2:
            raise SignalError(
                f"{self.path}: {signal} lies at {centre / 1e6:g} MHz +- {half / 1e6:g} MHz in "
                f"this file, outside its band of {low / 1e6:g} to {fs / 2e6:g} MHz; check lo_hz "
                f"({self.format.lo_hz / 1e6:g} MHz) and the sample rate, or leave the signal out"
            )

    def signals(self) -> list[str]:
        """Registered signals that the recording can hold."""
        return [s for s in signal_ids() if self._fits(s)]

    def _fits(self, signal: str) -> bool:
        try:
            self.check_signal(signal)
        except SignalError:
            return False
        return True


def check_file(path: Path) -> None:
    """Check that a path is a file that can be read.

    Raises:
        RecordingError: missing, not a file, or not readable.
    """
    if not path.exists():
        raise RecordingError(f"{path}: no such file; check the path")
    if not path.is_file():
        raise RecordingError(f"{path}: not a file; give the recording itself")
    try:
        path.open("rb").close()
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror}") from error


def _check_size(path: Path, size: int, format: RecordingFormat) -> None:
    if size <= 0:
        what = "empty" if size + format.offset_bytes <= 0 else "not longer than offset_bytes"
        raise RecordingError(f"{path}: the file is {what}; there are no samples in it")
    remainder = size * 8 % format.bits_per_sample
    if remainder:
        raise RecordingError(
            f"{path}: {size} bytes are not a whole number of {format.sample_format} samples "
            f"({format.bits_per_sample // 8} bytes each, {remainder // 8} left over); the file is "
            "cut off, or sample_format or offset_bytes is wrong"
        )
