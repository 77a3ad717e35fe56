"""Recordings synthesised while they are read, and what an acquisition would find in them."""

from dataclasses import fields
from pathlib import Path

import numpy as np

from sdr_spoof import _core
from sdr_spoof.records import Acquisition
from sdr_spoof.sources import RecordingFormat

RATE_HZ = 20e6
LO_HZ = 1568.259e6


class Synthetic:
    """A recording of given emitters."""

    def __init__(self, emitters, duration_s, *, rate_hz=RATE_HZ, lo_hz=LO_HZ, seed=5):
        self.path = Path("synthetic")
        self.gain = None
        self.format = RecordingFormat(sample_format="ci8", sample_rate_hz=rate_hz, lo_hz=lo_hz)
        self.sample_count = round(duration_s * rate_hz)
        self._synthesizer = _core.Synthesizer(
            "ci8", rate_hz, lo_hz, emitters, noise_rms_lsb=16.0, seed=seed
        )

    def read_raw(self, start, count):
        return self._synthesizer.generate(start, max(0, min(count, self.sample_count - start)))

    def check_signal(self, signal):
        pass

    def signals(self):
        return ["B1I", "B1CP"]


def seed_of(emitter, signal, prn, *, doppler_error_hz=4.0):
    """What a good acquisition at sample 0 would give."""
    spec = _core.signal_spec(signal)
    phase = float(emitter.code_phase_chips(np.zeros(1))[0])
    delay_s = (-phase % spec["code_length"] + 0.03) / spec["chip_rate_hz"]
    doppler_hz = float(emitter.doppler_hz(np.zeros(1))[0]) + doppler_error_hz
    return Acquisition(signal, prn, True, 0, doppler_hz, delay_s, 45.0, 99.0, 9.0, 50.0)


def same(a, b):
    for field in fields(a):
        x, y = getattr(a, field.name), getattr(b, field.name)
        if isinstance(x, np.ndarray):
            assert x.dtype == y.dtype
            assert x.tobytes() == y.tobytes(), field.name
        else:
            assert x == y, field.name
