"""Recordings on disk: complete, partial, refused."""

import errno
import json
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof.errors import OutputError
from sdr_spoof.scenario import Scenario, open_synthesizer, synthesis, synthesize, truth_path
from sdr_spoof.sources import open_recording


def scenario(sample_format: str = "ci8", duration_s: float = 0.6) -> Scenario:
    return Scenario.model_validate(
        {
            "title": "a secret",
            "recording": {
                "duration_s": duration_s,
                "sample_rate_hz": 6e6,
                "lo_hz": 1561e6 if sample_format[0] == "c" else 1559.5e6,
                "sample_format": sample_format,
            },
            "satellite": [{"prn": 19, "signals": ["B1I"]}],
        }
    )


@pytest.mark.parametrize(
    "sample_format", ["ri8", "ci8", "ri16", "ci16", "rf32", "cf32", "r2", "c2"]
)
def test_a_recording_reads_back(tmp_path: Path, sample_format: str) -> None:
    made = scenario(sample_format)
    seen: list[tuple[float, float]] = []
    meta = synthesize(made, tmp_path / "x", progress=lambda done, total: seen.append((done, total)))
    recording = open_recording(meta)
    assert recording.format.sample_format == sample_format
    assert recording.format.lo_hz == made.recording.lo_hz
    assert recording.sample_count == 3_600_000
    whole = open_synthesizer(made, threads=1).generate(0, 3_600_000)
    assert np.array_equal(recording.read_raw(0, 3_600_000), whole)
    assert seen[-1] == (3_600_000, 3_600_000)
    assert len(seen) > 2
    told = json.loads(truth_path(meta).read_text())
    assert (told["sample_count"], told["partial"]) == (3_600_000, False)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(
        [meta.name, recording.path.name, "x.truth.json"]
    )


def test_metadata_do_not_tell_the_truth(tmp_path: Path) -> None:
    meta = synthesize(scenario(duration_s=0.01), tmp_path / "x.sigmf-data")
    assert meta.name == "x.sigmf-meta"
    assert "secret" not in meta.read_text()
    assert open_recording(meta).extra == {"synthetic": True, "partial": False}


def test_nothing_is_overwritten_without_force(tmp_path: Path) -> None:
    synthesize(scenario(duration_s=0.01), tmp_path / "x")
    before = (tmp_path / "x.sigmf-data").read_bytes()
    with pytest.raises(OutputError, match=r"x.sigmf-data: exists already.*--force"):
        synthesize(scenario(duration_s=0.02), tmp_path / "x")
    assert (tmp_path / "x.sigmf-data").read_bytes() == before
    synthesize(scenario(duration_s=0.02), tmp_path / "x", force=True)
    assert (tmp_path / "x.sigmf-data").stat().st_size == 2 * len(before)


def test_interrupt_leaves_a_valid_partial_recording(tmp_path: Path) -> None:
    def stop(done: float, total: float) -> None:
        if done > total / 2:
            raise KeyboardInterrupt

    made = scenario()
    with pytest.raises(KeyboardInterrupt, match="marked partial"):
        synthesize(made, tmp_path / "x", progress=stop)
    recording = open_recording(tmp_path / "x.sigmf-meta")
    assert recording.extra["partial"] is True
    count = recording.sample_count
    assert 0 < count < made.recording.sample_count
    told = json.loads(truth_path(tmp_path / "x").read_text())
    assert (told["sample_count"], told["partial"]) == (count, True)
    whole = open_synthesizer(made).generate(0, count)
    assert np.array_equal(recording.read_raw(0, count), whole)


def test_interrupt_before_the_first_block_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(synthesis, "_write_all", stop)
    with pytest.raises(KeyboardInterrupt):
        synthesize(scenario(), tmp_path / "x")
    assert list(tmp_path.iterdir()) == []


def test_disk_that_fills_up_is_an_output_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(synthesis, "_write_all", full)
    with pytest.raises(OutputError, match="No space left on device; nothing was kept"):
        synthesize(scenario(), tmp_path / "x")
    assert list(tmp_path.iterdir()) == []


def test_disk_too_small_is_said_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="the disk is full: the recording needs"):
        synthesize(scenario(duration_s=1e9), tmp_path / "x")


def test_missing_folder_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="no such folder"):
        synthesize(scenario(), tmp_path / "none" / "x")
