"""Running campaigns: the same table whatever happens on the way."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import campaign_runs
import numpy as np
import pytest
from campaign_runs import SPEC, dice, failing_dice, spec_file

from sdr_spoof.campaign import engine, plan_campaign, read_table, run_campaign
from sdr_spoof.campaign.columns import columns_of
from sdr_spoof.campaign.journal import Journal, Record, read_journal
from sdr_spoof.campaign.runner import DIED, RunFunction
from sdr_spoof.campaign.workers import Workers
from sdr_spoof.errors import ConfigError, OutputError, RecordingError, SdrSpoofError


class Here(Executor):
    """Runs at once, in this process; ends results in another order than they were asked for."""

    def submit(self, function, /, *arguments):  # type: ignore[no-untyped-def]
        future: Future[Record] = Future()
        future.set_result(function(*arguments))
        return future


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    run_here(monkeypatch)


def run_here(monkeypatch: pytest.MonkeyPatch, executor: Executor | None = None) -> None:
    workers = Workers(executor or Here(), 1)
    monkeypatch.setattr(engine, "local", lambda _: _Open(workers))


class _Open:
    def __init__(self, workers: Workers) -> None:
        self.workers = workers

    def __enter__(self) -> Workers:
        return self.workers

    def __exit__(self, *_: object) -> None:
        pass


def table_bytes(folder: Path, function: RunFunction = dice, **options: object) -> bytes:
    plan = plan_campaign(spec_file(folder))
    results = run_campaign(plan, folder / "out", function=function, **options)  # type: ignore[arg-type]
    return (results.folder / "runs.h5").read_bytes()


@pytest.mark.usefixtures("here")
def test_the_table(tmp_path: Path) -> None:
    told = []
    plan = plan_campaign(spec_file(tmp_path))
    results = run_campaign(
        plan, tmp_path / "out", function=dice, progress=lambda *p: told.append(p)
    )
    assert told == [(k, 36) for k in range(37)]
    assert (results.total, results.found, results.failed) == (36, 0, 0)
    table = results.table
    assert len(table) == 36
    assert table.axes == ("drag_rate_m_s", "cn0_dbhz")
    assert table["point"].tolist() == sorted(list(range(6)) * 6)
    assert table["run"].tolist() == list(range(6)) * 6
    assert not table.partial
    row = 20
    point = plan.points[table["point"][row]]
    assert table["cn0_dbhz"][row] == point.scenario.satellite[0].cn0_dbhz
    expected = dice(point, int(table["seed"][row]))
    score = "C27.phase_difference_rate.score"
    assert table[score][row] == expected[score]
    assert table["C27.verdict"][row] == expected["C27.verdict"]
    assert table["C27.phase_difference_rate.alarmed"].dtype == np.int8
    assert np.isnan(table["C19.phase_difference_rate.alarm_s"]).all()
    assert (tmp_path / "out" / "campaign.toml").read_text() == SPEC
    again = read_table(tmp_path / "out" / "runs.h5")
    assert again.axes == table.axes
    assert again.spec == table.spec == plan.meaning
    assert list(again.columns) == list(table.columns)
    for name, column in table.columns.items():
        np.testing.assert_array_equal(again[name], column)


@pytest.mark.usefixtures("here")
def test_only_some_columns_are_kept(tmp_path: Path) -> None:
    plan = plan_campaign(spec_file(tmp_path, SPEC + '[output]\ncolumns = ["C27.*_rate.alarm_s"]\n'))
    names = list(run_campaign(plan, tmp_path / "out", function=dice).table.columns)
    assert names[:6] == ["point", "run", "seed", "error", "drag_rate_m_s", "cn0_dbhz"]
    assert [n for n in names[6:] if n.startswith("C27")] == [
        *("C27.attack", "C27.hostile", "C27.attack_start_s", "C27.capture_s", "C27.drag_start_s"),
        "C27.phase_difference_rate.alarm_s",
    ]


def test_one_and_two_processes_give_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders = [tmp_path / name for name in ("here", "one", "two")]
    for folder in folders:
        folder.mkdir()
    one, two = (table_bytes(f, workers=n) for n, f in enumerate(folders[1:], 1))
    run_here(monkeypatch)
    assert one == two == table_bytes(folders[0])


@pytest.mark.usefixtures("here")
def test_a_torn_journal_goes_on(tmp_path: Path) -> None:
    whole = table_bytes(tmp_path)
    journal = tmp_path / "out" / "runs.jsonl"
    content = journal.read_bytes()
    for length in (len(content) - 1, len(content) // 2, 10, 0):
        journal.write_bytes(content[:length])
        (tmp_path / "out" / "runs.h5").unlink()
        assert table_bytes(tmp_path) == whole
    plan = plan_campaign(tmp_path / "drag.toml")
    assert run_campaign(plan, tmp_path / "out", function=failing_dice).found == 36


@pytest.mark.usefixtures("here")
def test_a_killed_campaign_goes_on(tmp_path: Path) -> None:
    (tmp_path / "whole").mkdir()
    whole = table_bytes(tmp_path / "whole")
    script = (
        "from campaign_runs import slow_dice\n"
        "from sdr_spoof.campaign import plan_campaign, run_campaign\n"
        "if __name__ == '__main__':\n"
        "    plan = plan_campaign('drag.toml')\n"
        "    run_campaign(plan, 'out', workers=2, function=slow_dice)\n"
    )
    (tmp_path / "killed.py").write_text(script)
    spec_file(tmp_path)
    here = str(Path(campaign_runs.__file__).parent)
    process = subprocess.Popen(
        [sys.executable, "killed.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([here, *sys.path])},
        start_new_session=True,
    )
    journal = tmp_path / "out" / "runs.jsonl"
    deadline = time.monotonic() + 60
    while not (journal.exists() and len(journal.read_bytes().splitlines()) >= 5):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.01)
    process.kill()
    process.wait()
    assert 5 <= len(list(read_journal(journal))) < 36
    _wait_for_workers(process.pid)
    plan = plan_campaign(tmp_path / "drag.toml")
    results = run_campaign(plan, tmp_path / "out", function=dice)
    assert results.found >= 5
    assert (tmp_path / "out" / "runs.h5").read_bytes() == whole


def _wait_for_workers(session: int) -> None:
    """Until no process of the killed campaign is left: workers end with their parent."""
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        try:
            os.killpg(session, 0)
        except ProcessLookupError:
            return
        time.sleep(0.02)
    os.killpg(session, signal.SIGKILL)
    pytest.fail("workers outlived the campaign")


@pytest.mark.usefixtures("here")
def test_a_failing_run_does_not_stop_the_rest(tmp_path: Path) -> None:
    plan = plan_campaign(spec_file(tmp_path))
    results = run_campaign(plan, tmp_path / "out", function=failing_dice)
    assert results.failed == 12
    table = results.table
    failed = table["error"] != ""
    assert set(table["cn0_dbhz"][failed]) == {40.0}
    assert set(table["error"][failed]) == {"ValueError: no luck at all"}
    assert len(set(table["seed"][failed].tolist())) == 12
    assert set(table["C27.phase_difference_rate.alarmed"][failed]) == {-1}
    assert (table["C27.phase_difference_rate.alarmed"][~failed] >= 0).all()


def test_a_run_that_kills_its_worker_is_a_failing_run(tmp_path: Path) -> None:
    text = SPEC.replace("runs = 6", "runs = 1")
    plan = plan_campaign(spec_file(tmp_path, text))
    results = run_campaign(plan, tmp_path / "out", workers=2, function=campaign_runs.deadly_dice)
    assert results.table["error"].tolist() == ["", DIED, "", "", "", ""]


@pytest.mark.usefixtures("here")
def test_another_campaign_is_not_mixed_in(tmp_path: Path) -> None:
    table_bytes(tmp_path)
    changed = spec_file(tmp_path, SPEC.replace("seed = 5", "seed = 6"))
    plan = plan_campaign(changed)
    with pytest.raises(ConfigError, match=r"another campaign, with another campaign; .*--force"):
        run_campaign(plan, tmp_path / "out", function=dice)
    assert run_campaign(plan, tmp_path / "out", function=dice, force=True).found == 0
    other = replace(plan, columns=plan.columns[:3])
    with pytest.raises(ConfigError, match="with another columns"):
        run_campaign(other, tmp_path / "out", function=dice)


@pytest.mark.usefixtures("here")
def test_folders_that_cannot_be_used(tmp_path: Path) -> None:
    plan = plan_campaign(spec_file(tmp_path))
    with pytest.raises(OutputError, match="is a file; name a folder"):
        run_campaign(plan, plan.file, function=dice)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "runs.jsonl").write_text("mine")
    with pytest.raises(OutputError, match="exists already; name another folder or add --force"):
        run_campaign(plan, tmp_path / "out", function=dice)
    assert (tmp_path / "out" / "runs.jsonl").read_text() == "mine"
    run_campaign(plan, tmp_path / "out", function=dice, force=True)
    with (
        Journal(tmp_path / "out" / "runs.jsonl"),
        pytest.raises(OutputError, match="another process is running this campaign"),
    ):
        run_campaign(plan, tmp_path / "out", function=dice)
    (tmp_path / "out" / "campaign.json").write_text("{")
    with pytest.raises(OutputError, match=r"campaign\.json: damaged"):
        run_campaign(plan, tmp_path / "out", function=dice)
    with pytest.raises(RecordingError, match="is no table of a campaign"):
        read_table(tmp_path / "drag.toml")


@pytest.mark.usefixtures("here")
def test_ctrl_c_keeps_what_is_done(tmp_path: Path) -> None:
    whole = table_bytes(tmp_path)
    plan = plan_campaign(tmp_path / "drag.toml")

    def press(done: float, _: float) -> None:
        if done == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"7 of 36 runs are kept in .*; run the same"):
        run_campaign(plan, tmp_path / "out", function=dice, force=True, progress=press)
    partial = read_table(tmp_path / "out" / "runs.h5")
    assert partial.partial
    assert len(partial) == 7
    assert table_bytes(tmp_path) == whole


def test_the_disk_is_full(tmp_path: Path) -> None:
    with Journal(tmp_path / "runs.jsonl") as journal:
        journal._file.close()
        journal._file = Path("/dev/full").open("r+b", buffering=0)  # noqa: SIM115
        with pytest.raises(OutputError, match="no space left on the disk"):
            journal.append(Record(0, 0, 1, "", ()))


def test_the_cluster_goes_away(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Gone(Here):
        def submit(self, function, /, *arguments):  # type: ignore[no-untyped-def]
            future: Future[Record] = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    run_here(monkeypatch, Gone())
    with pytest.raises(SdrSpoofError, match="the cluster is gone; runs that ended are kept"):
        table_bytes(tmp_path)


def test_any_executor_will_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "threads").mkdir()
    with ThreadPoolExecutor(3) as threads:
        run_here(monkeypatch, threads)
        threaded = table_bytes(tmp_path / "threads")
    run_here(monkeypatch)
    assert table_bytes(tmp_path) == threaded


def test_the_journal_holds_what_floats_are(tmp_path: Path) -> None:
    values = (0.1, float("inf"), 1e-300, None, True, "a\nb", "µ")
    with Journal(tmp_path / "runs.jsonl") as journal:
        journal.append(Record(3, 1, 2**62 + 1, "", values))
    (record,) = read_journal(tmp_path / "runs.jsonl")
    assert record == Record(3, 1, 2**62 + 1, "", values)
    assert json.loads((tmp_path / "runs.jsonl").read_text())[:3] == [3, 1, 2**62 + 1]


def test_columns_are_known_before_the_runs(tmp_path: Path) -> None:
    names = [c.name for c in columns_of(plan_campaign(spec_file(tmp_path)).points[0])]
    assert set(dice(plan_campaign(spec_file(tmp_path)).points[0], 1)) <= set(names)
    assert "C19.B1CP.held_until_s" in names
    assert not [n for n in names if "B1CD" in n]
