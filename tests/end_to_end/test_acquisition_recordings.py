"""Real recordings: what acquisition finds against a third-party receiver's findings.

See vectors/recordings/README.md. A marginal satellite of the table may be found or not. So may a
satellite on C/A that the table lacks if another of its signals is in the table (EXTRA).
"""

import csv
import tomllib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof import _core
from sdr_spoof.acquisition import AcquisitionConfig, acquire
from sdr_spoof.errors import SignalError

VECTORS = Path(__file__).parents[1] / "vectors" / "recordings"
REAL = "L1_20211125_004000_12MHz_I"
IQ = "L1_20211202_084700_4MHz_IQ"


@dataclass(frozen=True)
class Format:
    sample_format: str
    sample_rate_hz: float
    lo_hz: float
    bandwidth_hz: float
    conjugate: bool = False
    float_scale: float = 1.0


class FileRecording:
    def __init__(self, name):
        sidecar = tomllib.loads((VECTORS / f"{name}.bin.toml").read_text())
        self.format = Format(**sidecar["recording"])
        self.raw = np.memmap(VECTORS / f"{name}.bin", np.uint8, "r").view(np.ndarray)
        self.width = _core.sample_format(self.format.sample_format)[0] // 8
        self.sample_count = len(self.raw) // self.width

    def read_raw(self, start, count):
        return self.raw[start * self.width : (start + count) * self.width]

    def check_signal(self, signal):
        if signal == "B1I":
            raise SignalError("B1I lies outside")

    def signals(self):
        return ["B1CD", "B1CP", "L1CA"]


def table(name, signal):
    with (VECTORS / f"{name}.csv").open() as f:
        return {int(r["prn"]): r for r in csv.DictReader(f) if r["signal"] == signal}


@lru_cache
def acquired(name, signal, threads=2):
    return acquire(FileRecording(name), AcquisitionConfig(), signals=[signal], threads=threads)


CASES = [(n, s) for n in (REAL, IQ) for s in ("L1CA", "B1CP")]


@pytest.mark.parametrize(("name", "signal"), CASES)
def test_every_certain_satellite_is_found(name, signal):
    found = {a.prn: a for a in acquired(name, signal) if a.detected}
    rows = {prn: r for prn, r in table(name, signal).items() if r["status"] == "certain"}
    assert len(rows) >= 10
    assert rows.keys() <= found.keys()
    spec = _core.signal_spec(signal)
    period_s = spec["code_length"] / spec["chip_rate_hz"]
    for prn, row in rows.items():
        a = found[prn]
        assert a.doppler_bin_hz == 0.5 / period_s
        assert abs(a.doppler_hz - float(row["doppler_hz"])) < 1.5 * a.doppler_bin_hz
        error_s = a.code_delay_s - float(row["code_start_ms"]) * 1e-3
        error_s -= round(error_s / period_s) * period_s
        assert abs(error_s * spec["chip_rate_hz"]) < 0.3


@pytest.mark.parametrize(("name", "signal"), CASES)
def test_no_false_satellite_among_all_prns(name, signal):
    searched = acquired(name, signal)
    assert [a.prn for a in searched] == _core.signal_spec(signal)["prns"]
    assert {a.prn for a in searched if a.detected} <= set(table(name, signal))
