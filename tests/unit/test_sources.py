"""Recordings: raw, sidecar, SigMF; large files; what is refused."""

from __future__ import annotations

import json
import resource
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from sdr_spoof import _core
from sdr_spoof.errors import ConfigError, RecordingError, SignalError
from sdr_spoof.sources import RecordingFormat, open_recording, sigmf_file

DEMO = RecordingFormat(
    sample_format="ri8", sample_rate_hz=120e6, lo_hz=1538.259e6, bandwidth_hz=50e6
)


def raw(tmp_path: Path, content: bytes, format: RecordingFormat) -> Path:
    path = tmp_path / "a.bin"
    path.write_bytes(content)
    return path


def with_format(name: str, **more: object) -> RecordingFormat:
    return RecordingFormat.model_validate(
        {"sample_format": name, "sample_rate_hz": 4e6, "lo_hz": 1575.42e6, **more}
    )


@pytest.mark.parametrize("name", _core.sample_formats())
def test_every_format_reads_whole_samples(tmp_path: Path, name: str) -> None:
    fmt = with_format(name, offset_bytes=3)
    content = bytes(range(64))
    recording = open_recording(raw(tmp_path, b"xyz" + content, fmt), fmt)
    assert recording.sample_count == 64 * 8 // fmt.bits_per_sample
    assert recording.duration_s == recording.sample_count / 4e6
    assert recording.read_raw(0, recording.sample_count).tobytes() == content
    per_byte = max(1, 8 // fmt.bits_per_sample)
    at = 4 * per_byte
    first = at * fmt.bits_per_sample // 8
    assert recording.read_raw(at, per_byte)[0] == content[first]


def test_reads_are_clipped_at_the_end(tmp_path: Path) -> None:
    fmt = with_format("ci16")
    recording = open_recording(raw(tmp_path, bytes(40), fmt), fmt)
    assert recording.read_raw(8, 100).size == 8
    assert recording.read_raw(10, 5).size == recording.read_raw(500, 5).size == 0
    with pytest.raises(ValueError, match="not be negative"):
        recording.read_raw(-1, 5)


def test_a_file_that_is_cut_while_it_is_read(tmp_path: Path) -> None:
    fmt = with_format("ci16")
    path = raw(tmp_path, bytes(4000), fmt)
    recording = open_recording(path, fmt)
    with path.open("r+b") as file:
        file.truncate(2000)
    assert recording.read_raw(0, 500).size == 2000
    with pytest.raises(RecordingError, match=r"a\.bin: cannot be read: it has become shorter"):
        recording.read_raw(0, 501)


def test_two_bit_reads_start_on_a_byte(tmp_path: Path) -> None:
    fmt = with_format("r2")
    recording = open_recording(raw(tmp_path, bytes(4), fmt), fmt)
    assert recording.sample_count == 16
    assert recording.read_raw(4, 5).size == 2
    with pytest.raises(ValueError, match="inside a byte"):
        recording.read_raw(2, 4)


def test_20_gb_file_is_not_read_into_memory(tmp_path: Path) -> None:
    path = tmp_path / "large.bin"
    with path.open("wb") as file:
        file.truncate(20_000_000_000 - 4)
        file.seek(0, 2)
        file.write(bytes([1, 2, 3, 4]))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    recording = open_recording(path, DEMO)
    assert recording.sample_count == 20_000_000_000
    assert recording.read_raw(recording.sample_count - 4, 100).tolist() == [1, 2, 3, 4]
    assert recording.read_raw(12_345_678_901, 1000).sum() == 0
    growth_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert growth_kib < 50_000


def test_sidecar(noise_file: Callable[..., Path]) -> None:
    path = noise_file()
    by_file, by_sidecar = open_recording(path), open_recording(f"{path}.toml")
    assert by_file.format == by_sidecar.format
    assert by_file.path == by_sidecar.path == path
    assert by_file.sample_count == 20_000


def test_sidecar_may_name_the_file(noise_file: Callable[..., Path]) -> None:
    path = noise_file()
    other = path.with_name("setup.toml")
    other.write_text(Path(f"{path}.toml").read_text() + 'file = "noise.bin"\n')
    assert open_recording(other).path == path


def test_given_values_win_over_the_sidecar(noise_file: Callable[..., Path]) -> None:
    recording = open_recording(noise_file(), {"lo_hz": 1e9, "sample_rate_hz": "8e6"})
    assert (recording.format.lo_hz, recording.format.sample_rate_hz) == (1e9, 8e6)
    assert recording.format.sample_format == "ci8"


@pytest.mark.parametrize("name", ["ri8", "ci8", "ri16", "ci16", "rf32", "cf32"])
def test_sigmf_round_trip(tmp_path: Path, name: str) -> None:
    fmt = with_format(name, conjugate=name[0] == "c", float_scale=30.0, bandwidth_hz=2.5e6)
    np.ones(16, np.float32).tofile(tmp_path / "a.sigmf-data")
    extra = {"description": "nothing", "scenario": {"seed": 4}}
    meta = sigmf_file.write_meta(tmp_path / "a", fmt, extra)
    for path in (meta, tmp_path / "a.sigmf-data"):
        recording = open_recording(path)
        assert recording.format == fmt
        assert recording.extra == {"scenario": {"seed": 4}}
    again = sigmf_file.write_meta(tmp_path / "a.sigmf-data", fmt, extra)
    assert again == meta


@pytest.mark.parametrize("name", ["rf32", "cf32"])
def test_float_scale_is_chosen_from_the_start_of_the_file(tmp_path: Path, name: str) -> None:
    values = np.random.default_rng(3).normal(0, 0.004, 1 << 22).astype(np.float32)
    values[:7] = [np.nan, np.inf, -np.inf, 0, 0, 0, 0]
    values[1 << 21 :] = 100.0  # beyond the measured part: another antenna must change nothing
    values.tofile(tmp_path / "a.bin")
    fmt = with_format(name)
    recording = open_recording(tmp_path / "a.bin", fmt)
    assert recording.format.float_scale == pytest.approx(30 / 0.004, rel=0.01)
    assert fmt.float_scale == 1.0
    with pytest.raises(RecordingError, match=r"rms of 0\.004 and would be rounded away"):
        open_recording(tmp_path / "a.bin", with_format(name, float_scale=1.0))
    with pytest.raises(RecordingError, match="would be clipped"):
        open_recording(tmp_path / "a.bin", with_format(name, float_scale=1e7))
    np.zeros(100, np.float32).tofile(tmp_path / "b.bin")
    with pytest.raises(RecordingError, match="are zero; check sample_format"):
        open_recording(tmp_path / "b.bin", fmt)


def test_sigmf_is_valid_for_the_sigmf_package(tmp_path: Path) -> None:
    from sigmf import sigmffile  # noqa: PLC0415

    np.arange(8, dtype=np.int8).tofile(tmp_path / "a.sigmf-data")
    meta = sigmf_file.write_meta(tmp_path / "a", with_format("ci8"))
    read = sigmffile.fromfile(meta, autoscale=False)
    read.validate()
    assert read.get_captures()[0]["core:frequency"] == 1575.42e6
    assert read.sample_count == 4


def test_foreign_sigmf_frequency(tmp_path: Path) -> None:
    """core:frequency is the frequency at 0 Hz of complex samples; of real ones it is not known."""
    (tmp_path / "a.sigmf-data").write_bytes(bytes(64))
    meta = sigmf_file.write_meta(tmp_path / "a", with_format("ci8"))
    meta.write_text(meta.read_text().replace('"sdr_spoof:lo_hz"', '"other:lo_hz"'))
    assert open_recording(meta).format.lo_hz == 1575.42e6
    meta.write_text(meta.read_text().replace('"ci8"', '"ri8"'))
    with pytest.raises(ConfigError, match=r"lo_hz not known.*--lo-hz"):
        open_recording(meta)
    assert open_recording(meta, {"lo_hz": 1.5e9}).format.lo_hz == 1.5e9


def test_sigmf_refusals(tmp_path: Path) -> None:
    data = tmp_path / "a.sigmf-data"
    data.write_bytes(bytes(64))
    with pytest.raises(RecordingError, match=r"metadata a\.sigmf-meta is missing"):
        open_recording(data)
    with pytest.raises(ConfigError, match="SigMF cannot hold r2"):
        sigmf_file.write_meta(data, with_format("r2"))
    meta = sigmf_file.write_meta(data, with_format("ci8"))
    good = meta.read_text()
    meta.write_text(good.replace('"ci8"', '"cu8"'))
    with pytest.raises(RecordingError, match="datatype cu8 is not supported"):
        open_recording(meta)
    for bad in ("{}", "not json", "[]", good.replace('"core:datatype"', '"x:y"')):
        meta.write_text(bad)
        with pytest.raises(RecordingError, match="not valid SigMF metadata"):
            open_recording(meta)
    meta.write_text(good)
    data.unlink()
    with pytest.raises(RecordingError, match="no such file"):
        open_recording(meta)
    archive = tmp_path / "a.sigmf"
    archive.write_bytes(b"x")
    with pytest.raises(RecordingError, match="unpack it with tar"):
        open_recording(archive)


@pytest.mark.parametrize(
    ("signal", "lo_hz", "sample_rate_hz", "name", "message"),
    [
        ("B1I", 1575.42e6, 4e6, "ci8", "outside its band of -2 to 2 MHz"),
        ("B1I", 1561.098e6, 2e6, "ci8", r"2 Msps is too low for B1I.*2\.046 Msps"),
        ("B1I", 1560e6, 4e6, "ri8", r"4 Msps is too low.*4\.092 Msps"),
        ("L1CA", 1575.42e6, 12e6, "ri8", "outside its band of 0 to 6 MHz"),
        ("L1CA", 1570e6, 12e6, "ri8", None),
        ("L1CA", 1572.42e6, 12e6, "ri8", None),
        ("L1CA", 1578.42e6, 12e6, "ri8", None),  # negative IF: spectrum mirrored
        ("B1CP", 1575.42e6, 2.046e6, "ci8", None),
        ("X9", 1575.42e6, 4e6, "ci8", "unknown signal 'X9'; known signals: B1I"),
    ],
)
def test_check_signal(
    noise_file: Callable[..., Path],
    signal: str,
    lo_hz: float,
    sample_rate_hz: float,
    name: str,
    message: str | None,
) -> None:
    path = noise_file(sample_format=name, sample_rate_hz=sample_rate_hz, lo_hz=lo_hz)
    recording = open_recording(path)
    if message is None:
        recording.check_signal(signal)
        assert signal in recording.signals()
    else:
        with pytest.raises(SignalError, match=message):
            recording.check_signal(signal)
        assert signal not in recording.signals()


def test_demo_format_holds_both_bands(tmp_path: Path) -> None:
    recording = open_recording(raw(tmp_path, bytes(8), DEMO), DEMO)
    assert {"B1I", "B1CD", "B1CP"} <= set(recording.signals())
    assert DEMO.band_hz == (1538.259e6, 1598.259e6)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("2023-03-12T08:00:00.25Z", 28800.25),
        ("2023-03-12T08:00:00", 28800),
        ("2023-03-12T16:00:00+08:00", 28800),
    ],
)
def test_sigmf_start_of_the_recording(tmp_path: Path, text: str, seconds: float) -> None:
    (tmp_path / "a.sigmf-data").write_bytes(bytes(64))
    meta = sigmf_file.write_meta(tmp_path / "a", with_format("ci8"))
    assert open_recording(meta).start is None
    document = json.loads(meta.read_text())
    document["captures"][0]["core:datetime"] = text
    meta.write_text(json.dumps(document))
    start = open_recording(meta).start
    assert start is not None
    assert (start - datetime(2023, 3, 12, tzinfo=UTC)).total_seconds() == seconds
    sigmf_file.write_meta(tmp_path / "a", with_format("ci8"), start=start)
    assert open_recording(meta).start == start
    document["captures"][0]["core:datetime"] = "yesterday"
    meta.write_text(json.dumps(document))
    with pytest.raises(RecordingError, match="yesterday"):
        open_recording(meta)
