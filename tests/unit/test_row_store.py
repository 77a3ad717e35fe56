"""Rows in a file are those in memory, whatever the pieces they came in; a full disk is an error."""

from __future__ import annotations

import dataclasses
import resource
import signal
import threading
from pathlib import Path

import numpy as np
import pytest
from simulated_tracks import Attack, Satellite, simulate_log

from sdr_spoof.config import Config
from sdr_spoof.errors import OutputError
from sdr_spoof.interrupt import held_back
from sdr_spoof.records import Acquisition, ComboTrack, SignalTrack, TrackLog
from sdr_spoof.report import write_report
from sdr_spoof.row_store import BLOCK_EPOCHS, RowStore
from sdr_spoof.sinks.hdf5 import Result, read_result, write_result
from sdr_spoof.sources import RecordingFormat
from sdr_spoof.verdict import detect


@pytest.fixture(scope="module")
def log() -> TrackLog:
    """30 s: 3000 epochs, more than two blocks."""
    attacked = Satellite(23, attack=Attack(start_s=12.0))
    return simulate_log(attacked, Satellite(24, lost=(8.0, 11.0)), duration_s=30.0)


def stored(log: TrackLog, folder: Path | None, piece: int = 700) -> TrackLog:
    """The same log with its rows in a store."""
    store = RowStore(folder)
    for kind, tracks in ((SignalTrack, log.signals), (ComboTrack, log.combos)):
        for start in range(0, tracks[0].epochs + 1, piece):
            parts = (track.part(start, start + piece) for track in tracks)
            store.append(kind, [vars(part) for part in parts])
    return dataclasses.replace(
        log, signals=store.tracks(SignalTrack), combos=store.tracks(ComboTrack)
    )


@pytest.mark.parametrize("piece", [1, BLOCK_EPOCHS, 2500, 10_000])
@pytest.mark.parametrize("on_disk", [False, True])
def test_columns_come_back(log: TrackLog, tmp_path: Path, piece: int, on_disk: bool) -> None:
    again = stored(log, tmp_path if on_disk else None, piece)
    for a, b in zip((*log.signals, *log.combos), (*again.signals, *again.combos), strict=True):
        assert b.epochs == a.epochs == 3000
        assert isinstance(b, type(a))
        for field in dataclasses.fields(a):
            np.testing.assert_array_equal(getattr(b, field.name), getattr(a, field.name))
            value = getattr(b.part(1000, 2100), field.name)
            np.testing.assert_array_equal(value, getattr(a.part(1000, 2100), field.name))
    assert list(tmp_path.iterdir()) == []


def test_no_rows_at_all(log: TrackLog, tmp_path: Path) -> None:
    empty = dataclasses.replace(log, signals=tuple(t.part(0, 0) for t in log.signals))
    (track, *_) = stored(empty, tmp_path).signals
    assert track.epochs == track.taps.shape[0] == 0
    assert track.taps.shape[1] == track.tap_offsets_s.size
    with pytest.raises(AttributeError, match="no attribute 'pseudorange_m'"):
        _ = track.pseudorange_m  # type: ignore[attr-defined]


def test_verdict_result_and_report_are_the_same(log: TrackLog, tmp_path: Path) -> None:
    config = Config()
    form = RecordingFormat(sample_format="ri8", sample_rate_hz=120e6, lo_hz=1538.259e6)
    found = [Acquisition("B1I", 23, True, 0, 2500.0, 1e-3, 45.0, 60.0, 22.0, 500.0)]
    names = []
    for name, case in (("memory", log), ("disk", stored(log, tmp_path))):
        verdict = detect(case, config.detection)
        assert verdict.spoofed
        result = Result("a", form, config.model_dump(mode="json"), tuple(found), case, verdict)
        write_result(tmp_path / f"{name}.h5", result)
        write_report(
            tmp_path / f"{name}.html",
            recording=None,
            acquisitions=found,
            log=case,
            verdict=verdict,
            detection=config.detection,
        )
        names.append(name)
    for ending in (".h5", ".html"):
        one, other = ((tmp_path / (name + ending)).read_bytes() for name in names)
        assert one == other
    assert detect(read_result(tmp_path / "disk.h5").log, config.detection) == verdict


def test_disk_full(log: TrackLog, tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, before[1]))
        with pytest.raises(OutputError, match=f"{tmp_path}: cannot be written: "):
            stored(log, tmp_path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_waits_for_the_end_of_a_block() -> None:
    done = False
    with pytest.raises(KeyboardInterrupt), held_back():
        signal.raise_signal(signal.SIGINT)
        done = True
    assert done
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_held_back_does_nothing_in_other_threads() -> None:
    failures: list[BaseException] = []

    def run() -> None:
        try:
            with held_back():
                pass
        except BaseException as error:
            failures.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert failures == []
