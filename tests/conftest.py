"""Fixtures that several tests share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

SIDECAR = """[recording]
sample_format = "{sample_format}"
sample_rate_hz = {sample_rate_hz}
lo_hz = {lo_hz}
"""


@pytest.fixture
def noise_file(tmp_path: Path) -> Callable[..., Path]:
    """Makes a raw file of 8-bit noise with its sidecar."""

    def make(
        name: str = "noise.bin",
        *,
        count: int = 20_000,
        sample_format: str = "ci8",
        sample_rate_hz: float = 4e6,
        lo_hz: float = 1575.42e6,
    ) -> Path:
        values = np.random.default_rng(1).normal(0, 20, count * (sample_format[0] == "c") + count)
        path = tmp_path / name
        values.round().astype(np.int8).tofile(path)
        text = SIDECAR.format(
            sample_format=sample_format, sample_rate_hz=sample_rate_hz, lo_hz=lo_hz
        )
        path.with_name(name + ".toml").write_text(text)
        return path

    return make
