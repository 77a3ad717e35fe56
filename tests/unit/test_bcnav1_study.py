"""The study of B-CNAV1's frame errors, in short."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sdr_spoof.studies import bcnav1


def test_frame_errors_are_where_the_study_says() -> None:
    """Subframe 2 fails once in a hundred below 18.5 dB-Hz of the data component, not at 18.75."""
    (point,) = bcnav1.measure([-1.25], 50)
    assert (point.data_cn0_dbhz, point.frames) == (18.75, 50)
    assert point.signal_cn0_dbhz == pytest.approx(24.77, abs=0.01)
    # 4 standard errors above 0.1 % and 0.3 % of 50 frames.
    assert point.subframe2_rate <= 0.02
    assert point.subframe3_rate <= 0.035
    assert point.undetected == 0
    assert point.first_rate <= 0.02


def test_error_rate_does_not_beat_the_best_code() -> None:
    (point,) = bcnav1.measure([-2.25], 25)
    for name, rate in (("subframe 2", point.subframe2_rate), ("subframe 3", point.subframe3_rate)):
        best = bcnav1.best_rate(-2.25, *bcnav1.LENGTHS[name])
        assert rate > best - 4 * np.sqrt(best / 25)


def test_normal_approximation_at_known_values() -> None:
    # Capacity of the binary-input channel is 1/2 at an Es/N0 of -2.823 dB (textbooks).
    assert bcnav1.best_rate(-2.823, 10**6, 5 * 10**5) == pytest.approx(0.5, abs=0.05)
    assert bcnav1.crossing([0.0, 1.0], [1e-1, 1e-3]) == pytest.approx(0.5)
    assert np.isnan(bcnav1.crossing([0.0, 1.0], [1.0, 0.5]))


def test_results_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bcnav1, "ES_N0_DB", (-1.5, 0.0))
    result = bcnav1.run(tmp_path, frames=25)
    assert len(result["points"]) == 2
    assert {p.name for p in tmp_path.iterdir()} == {"bcnav1.json", "bcnav1.csv", "bcnav1.png"}
