"""``sdr-spoof campaign``: from the file to tables and figures, on one machine and on a cluster."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from commands import SCRIPT, failing

from sdr_spoof.campaign import plan_campaign, read_table, workers
from sdr_spoof.campaign.run import run as run_once
from sdr_spoof.cli import main

SPEC = """
[campaign]
title = "A quick one"
runs = {runs}
level = "{level}"

[scenario.recording]
duration_s = 3.0
sample_rate_hz = 20e6
lo_hz = 1568.259e6
sample_format = "ci8"

[[scenario.satellite]]
prn = 27
signals = ["B1I", "B1CP"]

[[scenario.attack]]
prn = 27
signals = ["B1CP"]
start_s = 1.5
power_start_db = 0.0
drag_start_s = 1.6
drag_ramp_s = 0.1

[detection]
settle_s = 0.1
window_s = 0.3
min_tested_s = 0.5

[[sweep]]
key = "scenario.attack.0.drag_rate_m_s"
values = [0.5, 2.0]
"""


def spec_file(folder: Path, runs: int = 2, level: str = "correlator") -> Path:
    path = folder / "quick.toml"
    path.write_text(SPEC.format(runs=runs, level=level))
    return path


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("campaign")
    spec = spec_file(folder)
    assert main(["campaign", str(spec), "-o", str(folder / "out"), "--workers", "1"]) == 0
    return folder / "out"


def test_results(finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = read_table(finished / "runs.h5")
    assert table["point"].tolist() == [0, 0, 1, 1]
    assert table["error"].tolist() == [""] * 4
    assert set(table["C27.attack"]) == {"induced"}
    assert (table["C27.B1CP.held_until_s"] > 1.4).all()
    assert {"detection.csv", "detection.png", "coverage.csv", "latency.png"} <= {
        p.name for p in finished.iterdir()
    }
    spec = spec_file(tmp_path)
    capsys.readouterr()
    assert main(["campaign", str(spec), "-o", str(finished), "--json"]) == 0
    printed = capsys.readouterr()
    data = json.loads(printed.out)
    assert printed.err == ""
    assert (data["points"], data["runs"], data["found"], data["failed"]) == (2, 4, 4, 0)
    assert {"phase_difference_rate", "verdict"} <= {r["detector"] for r in data["coverage"]}


@pytest.mark.parametrize("level", ["correlator", "if"])
def test_a_run_is_a_function_of_point_and_seed(level: str, tmp_path: Path) -> None:
    point = plan_campaign(spec_file(tmp_path, level=level)).points[1]
    first, again, other = (run_once(point, seed) for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert first["C27.attack_start_s"] == 1.5
    assert first["C27.drag_start_s"] == 1.6
    for row in (first, other):
        assert row["C27.B1CP.cn0_dbhz"] == pytest.approx(45.0, abs=6.0)  # two signals beat
        assert row["C27.B1I.cn0_dbhz"] == pytest.approx(45.0, abs=1.0)
        assert row["C27.phase_difference_rate.tested_s"] > 0.5


def test_dry_run_and_mistakes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "CONNECT_S", 0.5)
    spec = spec_file(tmp_path)
    out = tmp_path / "out"
    assert main(["campaign", str(spec), "-o", str(out), "--dry-run", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["points"] == [
        {"point": 0, "drag_rate_m_s": 0.5},
        {"point": 1, "drag_rate_m_s": 2.0},
    ]
    assert main(["campaign", str(spec), "-o", str(out), "--dry-run"]) == 0
    assert "2 points x 2 runs = 4 runs" in capsys.readouterr().out
    code, message = failing(capsys, "campaign", tmp_path / "none.toml", "-o", out)
    assert code == 2
    assert "none.toml: cannot be read: No such file" in message
    code, message = failing(capsys, "campaign", spec, "-o", out, "--cluster", "tcp://127.0.0.1:9")
    assert code == 2
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in message
    spec.write_text(spec.read_text().replace("runs = 2", "runs = 0"))
    assert "[campaign] runs: " in failing(capsys, "campaign", spec, "-o", out)[1]


def test_ctrl_c_and_on(tmp_path: Path) -> None:
    """Ctrl-C on the terminal reaches the workers too; they leave it to their parent."""
    spec = spec_file(tmp_path, runs=2000)
    command = [SCRIPT, "campaign", spec, "-o", tmp_path / "out", "--workers", "1"]
    process = subprocess.Popen(
        [str(c) for c in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    journal = tmp_path / "out" / "runs.jsonl"
    deadline = time.monotonic() + 60
    while not (journal.exists() and journal.stat().st_size):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert out == ""
    assert "Traceback" not in err
    assert f"of 4000 runs are kept in {tmp_path / 'out'}; run the same command again" in err
    partial = read_table(tmp_path / "out" / "runs.h5")
    assert partial.partial
    assert 0 < len(partial) < 4000


@pytest.fixture
def dask_cluster(tmp_path: Path) -> Iterator[str]:
    """A scheduler and two workers on this machine, each a process; yields the address."""
    pytest.importorskip("distributed")
    told = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    scheduler = ["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    worker = ["worker", "--scheduler-file", str(told), "--nthreads", "1", "--no-nanny"]
    local = ["--host", "127.0.0.1", "--no-dashboard", "--local-directory", str(tmp_path)]
    with ExitStack() as stack:
        for command in (
            [*scheduler, "--scheduler-file", str(told)],
            [*worker, *local],
            [*worker, *local],
        ):
            log = stack.enter_context((tmp_path / "dask.log").open("a"))
            process = subprocess.Popen([*dask, *command], stdout=log, stderr=log)
            stack.callback(process.wait)
            stack.callback(process.kill)
        deadline = time.monotonic() + 60
        while not told.exists() or "address" not in told.read_text():
            assert time.monotonic() < deadline, (tmp_path / "dask.log").read_text()
            time.sleep(0.05)
        while (tmp_path / "dask.log").read_text().count("Starting established connection") < 4:
            assert time.monotonic() < deadline, (tmp_path / "dask.log").read_text()
            time.sleep(0.05)
        yield json.loads(told.read_text())["address"]


@pytest.mark.filterwarnings("default")  # those of the cluster's own
def test_a_cluster_gives_the_same_bytes(
    dask_cluster: str, finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = spec_file(tmp_path)
    out = tmp_path / "out"
    assert main(["campaign", str(spec), "-o", str(out), "--cluster", dask_cluster, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["failed"] == 0
    for name in ("runs.h5", "detection.csv", "roc.csv", "coverage.csv", "detection.png"):
        assert (out / name).read_bytes() == (finished / name).read_bytes(), name
