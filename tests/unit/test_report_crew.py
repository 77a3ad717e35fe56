"""Pictures drawn by processes, and on sheets that others were drawn on: the same bytes."""

import dataclasses
import io
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from simulated_tracks import Satellite, simulate_log

from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.report import crew as crew_module
from sdr_spoof.report import write_report
from sdr_spoof.report.crew import Crew, crew_for, finish
from sdr_spoof.report.evidence import EvidenceBook
from sdr_spoof.report.figures.panels import Look, Panel, Stroke
from sdr_spoof.report.figures.quiet import QuietDrawing
from sdr_spoof.report.figures.satellite import SatelliteDrawing
from sdr_spoof.report.figures.sheet import Sheets
from sdr_spoof.report.pictures import Pictures
from sdr_spoof.report.words import ordered
from sdr_spoof.satellites import tracks_of
from sdr_spoof.verdict import detect

CONFIG = DetectionConfig()


@pytest.fixture(scope="module")
def log():
    return simulate_log(Satellite(24), Satellite(25), duration_s=6.0)


@pytest.fixture(scope="module")
def details(log):
    tracks = [tracks_of(log, "C", prn) for prn in (24, 25)]
    return [SatelliteDrawing.of(mine, None, log.duration_s) for mine in tracks]


def report(log, path, crew):
    """As ``process`` makes it: what can be drawn is asked for early."""
    pictures, book = Pictures(crew), EvidenceBook(CONFIG)
    pictures.tracked(log)
    verdict = detect(log, CONFIG, look=book.take)
    pictures.judged(log, verdict, book, ordered(verdict))
    told = {"log": log, "verdict": verdict, "detection": CONFIG, "book": book}
    write_report(path, recording=None, acquisitions=[], **told, pictures=pictures)
    return path.read_bytes()


def test_any_number_of_processes_gives_the_same_report(log, tmp_path):
    found = []
    for count in (0, 1, 2):
        with Crew(count) as crew:
            found.append(report(log, tmp_path / f"{count}.html", crew))
    assert found[0] == found[1] == found[2]


def test_a_verdict_changes_what_was_asked_for_before(log):
    """Drawn as if nothing alarmed; then there is an onset, which parts the picture elsewhere."""
    verdict = detect(log, CONFIG)
    first, second = verdict.satellites
    satellites = (dataclasses.replace(first, onset_s=2.0), second)
    verdict = dataclasses.replace(verdict, satellites=satellites)
    with Crew(1) as crew:
        pictures = Pictures(crew)
        pictures.tracked(log)
        pictures.judged(log, verdict, EvidenceBook(CONFIG), satellites)
        for satellite in satellites:
            tracks = tracks_of(log, "C", satellite.prn)
            alone = SatelliteDrawing.of(tracks, satellite.onset_s, log.duration_s)
            assert pictures.detail(log, satellite).png() == alone.png(Sheets())


def test_a_sheet_remembers_nothing_of_other_pictures(details):
    fresh = [drawing.png(Sheets()) for drawing in details]
    used = Sheets()
    assert [drawing.png(used) for drawing in details] == fresh
    assert details[0].png(used) == fresh[0]


def test_a_picture_that_fails_leaves_nothing_on_the_sheet(details):
    sheet = Sheets().of(details[0].frame)
    first = sheet.png(details[0]._fill)

    def fail(panels):
        panels[0].plot([0, 1], [0, 1e6])
        raise RuntimeError("half-way")

    with pytest.raises(RuntimeError, match="half-way"):
        sheet.png(fail)
    assert sheet.png(details[0]._fill) == first


@pytest.mark.parametrize("symlog", [None, (1.0, 0.7)])
def test_axes_that_move_follow_the_lines(symlog):
    """Twice the size: other labels, so other pixels left of the axis; the rest stays."""
    time_s = np.linspace(0.0, 10.0, 50)
    look = Look("x", 1.5, quiet=(-1, 1), bounds=(-1, 1), symlog=symlog)
    sheets = Sheets()
    pixels = []
    for size in (3.0, 300.0, 3.0):
        stroke = Stroke(time_s, size * np.sin(time_s), "#000000")
        ticks = (-size, 0.0, size) if symlog else None
        panel = Panel(look, (stroke,), limits=(-2 * size, 2 * size), ticks=ticks)
        png = QuietDrawing.of([panel], ["B1I"], 10.0).png(sheets)
        pixels.append(np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=int))
    np.testing.assert_array_equal(pixels[0], pixels[2])
    changed = np.abs(pixels[1] - pixels[0]).max(axis=2) > 30  # twice what 256 colours are off
    assert changed[:, 50:115].any()
    assert not changed[-55:].any()  # labels of the time axis


def test_what_a_dead_process_leaves_is_drawn_here(details):
    with Crew(1) as crew:
        pictures = [crew.ask(drawing) for drawing in details]
        for process in crew._processes:
            process.kill()
        assert [p.png() for p in pictures] == [d.png(Sheets()) for d in details]


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_a_process_that_hangs_holds_nothing_up(details, monkeypatch):
    monkeypatch.setattr(crew_module, "PATIENCE_S", 0.01)
    with Crew(1) as crew:
        crew._processes[0].send_signal(signal.SIGSTOP)
        pictures = [crew.ask(drawing) for drawing in details]
        assert [p.png() for p in pictures] == [d.png(Sheets()) for d in details]


def test_mistakes_of_a_drawing_reach_who_asked(details):
    """The process ends with it; drawn here, it raises."""
    broken = SatelliteDrawing(details[0].frame, ((),), ((),), None)  # no lines for its signals
    with Crew(1) as crew:
        bad, good = crew.ask(broken), crew.ask(details[0])
        with pytest.raises(ValueError, match="zip"):
            bad.png()
        assert good.png() == details[0].png(Sheets())


def test_no_process_outlives_its_crew(details):
    with pytest.raises(KeyboardInterrupt), Crew(2) as crew:
        processes = crew._processes
        finish([crew.ask(drawing) for drawing in details[:1]])
        raise KeyboardInterrupt
    assert all(process.returncode is not None for process in processes)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_script_without_a_guard_may_be_killed(tmp_path):
    """Its process does not run the script again, does not see Ctrl-C, and ends with it."""
    script = tmp_path / "script.py"
    script.write_text(
        "import sys, time\n"
        "from sdr_spoof.report.crew import Crew\n"
        "crew = Crew(1)\n"
        "print(crew._processes[0].pid, flush=True)\n"
        "time.sleep(60)\n"
    )
    parent = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True)
    with parent:
        child = int(parent.stdout.readline())
        assert os.getsid(child) != os.getsid(parent.pid)
        parent.send_signal(signal.SIGKILL)
    until = time.monotonic() + 30.0
    while _alive(child) and time.monotonic() < until:
        time.sleep(0.01)
    assert not _alive(child)


def _alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    stat = Path(f"/proc/{pid}/stat").read_text()  # one that nobody waits for stays as a zombie
    return stat.rpartition(")")[2].split()[0] != "Z"


def test_one_thread_means_no_process():
    with crew_for(1) as crew:
        assert crew.alone
