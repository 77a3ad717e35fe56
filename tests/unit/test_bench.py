"""The benchmark measures every stage; how fast is not asserted."""

from __future__ import annotations

import importlib.util
import platform
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from sdr_spoof import _core
from sdr_spoof.bench import Measurement, Settings, machine, report, run
from sdr_spoof.bench.plan import jobs
from sdr_spoof.bench.targets import TARGETS
from sdr_spoof.bench.worker import timed
from sdr_spoof.bench.workloads import RATES, channels, recording, shared_out, taps
from sdr_spoof.errors import ConfigError, SdrSpoofError
from sdr_spoof.studies import speed

if TYPE_CHECKING:
    from types import ModuleType


SHORT = Settings(
    msps=(5,),
    threads=(1,),
    level=_core.simd_level(),
    repeats=2,
    recording_s=0.5,
    engine_s=0.04,
)
MEASURED = Measurement(
    stage="receiver",
    workload="W1",
    sample_rate_hz=120e6,
    level="avx512",
    threads=1,
    channels=24,
    signal_s=4.0,
    lowest_s=0.4,
    median_s=0.5,
    highest_s=0.8,
    times_real_time=8.0,
    channels_per_core=192.0,
    us_per_ms_channel=5.2,
    peak_memory_mb=401.0,
)


def test_every_stage_is_measured(tmp_path: Path) -> None:
    results = run(replace(SHORT, folder=tmp_path))
    assert [(m.stage, m.workload, m.channels) for m in results] == [
        ("receiver", "W1", 12),
        ("engine", "W1", 12),
        ("channel", "B1I", 1),
        ("acquisition", "B1I", 63),
        ("synthesis", "12 emitters", 12),
    ]
    for m in results:
        assert m.lowest_s <= m.median_s <= m.highest_s
        assert m.times_real_time == pytest.approx(m.signal_s / m.median_s)
        assert m.channels_per_core == pytest.approx(m.times_real_time * m.channels)
        assert m.us_per_ms_channel == pytest.approx(1e3 / m.channels_per_core)
        assert 20 < m.peak_memory_mb < 2000
    assert {path.name for path in tmp_path.glob("*.sigmf-meta")} == {"bench_5Msps_0.5s.sigmf-meta"}


def test_recordings_are_kept(tmp_path: Path) -> None:
    first = recording(RATES[5], 0.05, tmp_path)
    made = first.path.stat().st_mtime_ns
    assert recording(RATES[5], 0.05, tmp_path).path.stat().st_mtime_ns == made
    first.path.write_bytes(b"cut off!")
    assert recording(RATES[5], 0.05, tmp_path).sample_count == first.sample_count


def test_a_run_without_lock_is_not_measured() -> None:
    with pytest.raises(SdrSpoofError, match="not every signal is synchronised"):
        run(replace(SHORT, stages=("receiver",), recording_s=0.05))


def test_portable_instructions_are_compared_with_the_best() -> None:
    made = list(jobs(Settings(stages=("engine", "channel"), threads=(1, 2))))
    fast = {j.msps for j in made if j.level == "portable"}
    assert fast == ({120} if _core.simd_level() != "portable" else {5, 25, 60, 120})
    assert {j.workload for j in made if j.msps < 60} == {"W1"}
    assert {j.workload for j in made if j.stage == "engine" and j.msps >= 60} == {"W1", "W2"}
    # What one channel more costs is asked of one thread.
    assert [j.threads for j in made if j.stage == "channel"] == [1]


@pytest.mark.parametrize(
    "wrong", [{"msps": (7,)}, {"stages": ("tracking",)}, {"level": "mmx"}], ids=str
)
def test_unknown_choices_are_named(wrong: dict[str, object]) -> None:
    with pytest.raises(ConfigError, match="cannot be measured here; choose"):
        Settings(**wrong)  # type: ignore[arg-type]


def test_a_job_runs_at_its_level_or_not_at_all() -> None:
    job = next(jobs(replace(SHORT, stages=("engine",))))
    with pytest.raises(SdrSpoofError, match="not other"):
        timed(replace(job, level="other"), 1)


def test_the_engine_correlates_every_channel() -> None:
    rate = RATES[60]
    groups = shared_out(channels("W2", rate), 3, rate)
    engine = _core.EngineBench(rate.sample_format, rate.sample_rate_hz, rate.lo_hz, groups, [0])
    raw = np.zeros(round(0.02 * rate.sample_rate_hz), np.uint8)
    engine.feed(raw, 1)
    # From the second time on, all are under way: a slice a millisecond, give or take one.
    assert engine.feed(raw, 3) == pytest.approx(24 * 60, abs=24)


@pytest.mark.parametrize("workload", ["W1", "W2"])
@pytest.mark.parametrize("threads", [1, 2, 3, 5, 40])
def test_channels_are_shared_out(workload: str, threads: int) -> None:
    rate = RATES[120]
    made = channels(workload, rate)
    groups = shared_out(made, threads, rate)
    assert [c for group in groups for c in group] == made
    assert len(groups) <= threads
    assert all(groups)


def test_threads_of_w1_mix_one_band_each() -> None:
    for threads, bands in ((2, ["B1I", "B1CP"]), (4, ["B1I", "B1I", "B1CP", "B1CP"])):
        groups = shared_out(channels("W1", RATES[120]), threads, RATES[120])
        assert [{c[0] for c in group} for group in groups] == [{band} for band in bands]
        assert {len(group) for group in groups} == {24 // threads}


def test_taps_are_as_far_apart_in_time_at_every_rate() -> None:
    assert taps(RATES[120]) == [-16, -8, 0, 8, 16]
    assert taps(RATES[60]) == [-8, -4, 0, 4, 8]
    assert taps(RATES[5]) == [-2, -1, 0, 1, 2]


def test_targets_are_met_or_missed() -> None:
    slow = replace(MEASURED, threads=2, median_s=0.4, lowest_s=0.39, highest_s=0.5)
    other = replace(MEASURED, sample_rate_hz=60e6, threads=2)
    text = report.markdown(machine(), 0.0, [MEASURED, other, slow])
    rows = {line.split(" | ")[0].strip("| "): line for line in text.splitlines()}
    assert rows["W1, whole receiver"].split(" | ")[1:] == [
        "≥ 6 x",
        "8 x (5 to 10)",
        "≥ 11 x",
        "10 x (8 to 10.3), missed |",
    ]
    assert rows["memory, W1, whole receiver"].count("401 MB, missed") == 2
    assert rows["W1, whole receiver, portable"].count("not measured") == 2
    assert len([line for line in rows if line in {t.name for t in TARGETS}]) == len(TARGETS)


def test_the_machine_is_named() -> None:
    here = machine()
    assert here.processor
    assert here.cores >= 1
    assert _core.simd_level() in here.levels


def test_the_study_of_speed_draws_its_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, values in (("MSPS", (5, 20)), ("CHANNELS", (0, 4)), ("TAPS", (1, 3))):
        monkeypatch.setattr(speed, name, values)
    monkeypatch.setattr(speed, "SLOPE", (2, 4))
    result = speed.run(tmp_path, signal_s=0.02, repeats=1)
    against = [row["against"] for row in result["costs"]]
    # One kind of channel is too wide for the lowest rate.
    assert [against.count(x) for x in ("msps", "channels", "taps")] == [9, 6, 4]
    assert against.count("threads") == 4 * machine().cores
    assert {path.name for path in tmp_path.iterdir()} == {
        "speed.json",
        "speed_scaling.csv",
        "speed_scaling.png",
    }


@pytest.fixture
def instructions() -> ModuleType:
    """The script in benches/."""
    path = Path(__file__).parents[2] / "benches" / "instructions.py"
    spec = importlib.util.spec_from_file_location("instructions", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_more_instructions_fail_the_check(
    instructions: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    built = {"compiler": "rustc 0.1", "machine": platform.machine()}
    kept = {"built": built, "avx2": {"W1": 1000, "W2": 1000}}
    instructions.compare({"avx2": {"W1": 1029, "W2": 950}}, kept)
    assert "better: avx2 W2: 950 instructions" in capsys.readouterr().out
    with pytest.raises(SystemExit, match="make bench-update"):
        instructions.compare({"avx2": {"W1": 1031, "W2": 1000}}, kept)
    shown = capsys.readouterr().err
    assert "avx2 W1: 1,031 instructions, 1,000 before (+3.1%)" in shown
    assert "W2" not in shown
    assert "rustc 0.1 before" in shown
