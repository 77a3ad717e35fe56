"""Level of float samples, which the receiver rounds to 16 bits: chosen or checked on opening.

The level is measured on a fixed part of the file, so that results depend on the file alone.
"""

from __future__ import annotations

import numpy as np

from sdr_spoof.errors import RecordingError

from .recording import Recording

TARGET_RMS = 30.0
"""Rounding to integers then adds a noise 40 dB below the signal; 60 dB of headroom remain."""
MEASURED_SAMPLES = 1 << 20
"""Samples at the start of the file over which the level is measured."""
_LOWEST_RMS, _HIGHEST_RMS = 0.5, 10_000.0


def scaled(recording: Recording) -> Recording:
    """Give a float recording its ``float_scale``, or check the one it has; others pass through.

    Raises:
        RecordingError: the measured part is silent, or the given scale loses or clips the signal.
    """
    form = recording.format
    if not form.sample_format.endswith("f32"):
        return recording
    rms = _rms(recording)
    if "float_scale" in form.model_fields_set:
        _check(recording, rms * form.float_scale)
        return recording
    if rms == 0.0:
        raise RecordingError(
            f"{recording.path}: the first {_measured(recording)} samples are zero; check "
            "sample_format and offset_bytes, or give float_scale"
        )
    # Three digits, so that it reads well where it is shown.
    form = form.model_copy(update={"float_scale": float(f"{TARGET_RMS / rms:.3g}")})
    return Recording(recording.path, form, recording.extra, recording.start)


def _measured(recording: Recording) -> int:
    return min(recording.sample_count, MEASURED_SAMPLES)


def _rms(recording: Recording) -> float:
    """Root mean square of I and of Q, of the values that are numbers."""
    raw = recording.read_raw(0, _measured(recording))
    numbers = raw.view(np.dtype("<f4")).astype(np.float64)
    numbers = numbers[np.isfinite(numbers)]
    return float(np.sqrt(np.mean(numbers**2))) if numbers.size else 0.0


def _check(recording: Recording, rms: float) -> None:
    if _LOWEST_RMS <= rms <= _HIGHEST_RMS:
        return
    fate = "rounded away" if rms < _LOWEST_RMS else "clipped"
    raise RecordingError(
        f"{recording.path}: with float_scale {recording.format.float_scale:g} the samples have an "
        f"rms of {rms:.3g} and would be {fate} in 16 bits; leave float_scale out to have it "
        f"chosen, or aim at an rms of {TARGET_RMS:g}"
    )
