"""Pocket SDR receives our B1I and B1C."""

from __future__ import annotations

import os
import re
import subprocess
from collections import defaultdict
from pathlib import Path

import debian
import rtklib
from outcome import Errors, Outcome, PeerMissingError, Place
from recordings import BOTH_BANDS, Recording, fixes, synthesise

VARIABLE = "POCKET_SDR"
MOST_M = 10.0
LEAST_FIXES = 5
SLOWER = 0.25
"""Its clock against ours: it drops samples where it cannot follow."""
KEPT = ".pocket_navdata.csv"
"""Messages of its last run, which it would begin with."""
_TRACKER = Path("app/pocket_trk/pocket_trk")
_CONVERTER = Path("app/convbin/convbin")
DATE = "2023/3/12"
"""Of the recording: RTCM has no weeks."""


def run(folder: Path) -> list[Outcome]:
    """60 s of both bands: it must find every satellite, decode its messages and range right.

    It takes an ephemeris only when it came twice, after 60 s and more: positions are RTKLIB's, from
    its pseudoranges of B1I and the ephemerides that our receiver decoded.
    """
    program, solver = _program(), debian.require("rnx2rtkp", "rtklib")
    recording = synthesise(BOTH_BANDS, folder)
    log = _receive(program, recording, folder / "pocket-sdr")
    own = fixes(recording, folder / "both-bands")
    theirs = _observations(program, folder / "pocket-sdr")
    found = rtklib.solve(solver, theirs, own / "navigation.rnx")
    return [_signals(log, recording), _position(log, found, recording)]


def _program() -> Path:
    root = os.environ.get(VARIABLE)
    built = [Path(root or "").resolve() / p for p in (_TRACKER, _CONVERTER)]
    if root is None or not all(p.is_file() for p in built):
        raise PeerMissingError(
            f"build {_TRACKER} and {_CONVERTER} of Pocket SDR (tomojitakasu/PocketSDR on GitHub) "
            f"and set {VARIABLE} to its folder"
        )
    return built[0]


def _receive(program: Path, recording: Recording, folder: Path) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    log = folder.resolve() / "pocket.log"
    stream = log.with_suffix(".rtcm3")
    for old in (log, stream, folder / KEPT):
        old.unlink(missing_ok=True)
    beidou = [int(s[1:]) for s in recording.satellites if s[0] == "C"]
    third = ",".join(str(p) for p in beidou if 19 <= p < 59)
    everyone = ",".join(map(str, beidou))
    signals = ["-sig", "B1CP", "-prn", third, "-sig", "B1CD", "-prn", third]
    signals += ["-sig", "B1I", "-prn", everyone]
    form = ["-fmt", "CS8", "-f", "20", "-fo", "1568.259", "-tscale", str(SLOWER), "-ti", "0"]
    command = [program, *signals, *form, "-log", log, "-rtcm", stream, recording.data.resolve()]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return log.read_text(errors="replace")


def version(log: str) -> str:
    """As its log has it."""
    found = re.search(r"VER=([\d.]+)", log)
    return f"Pocket SDR {found[1] if found else ''}".strip()


def _signals(log: str, recording: Recording) -> Outcome:
    frames: dict[str, set[str]] = defaultdict(set)
    count: dict[str, int] = defaultdict(int)
    for row in log.splitlines():
        fields = row.split(",")
        if fields[0] == "$NAV":
            frames[fields[3]].add(fields[2])
            count[fields[3]] += 1
    wrong = len(re.findall("FRAME ERROR", log))
    third = {s for s in recording.satellites if s[0] == "C" and 19 <= int(s[1:]) < 59}
    passed = frames["B1I"] >= set(recording.satellites) and frames["B1CD"] >= third and not wrong
    figures = ", ".join(
        f"{s}: {count[s]} frames of {len(frames[s])} satellites" for s in ("B1I", "B1CD")
    )
    return Outcome(version(log), "our messages", passed, f"{figures}; {wrong} frames in error")


def _observations(program: Path, folder: Path) -> Path:
    """RINEX of its RTCM stream."""
    converter = program.parents[2] / _CONVERTER
    rinex = folder / "pocket.obs"
    form = ["-r", "rtcm3", "-tr", DATE, "00:00:00", "-v", "3.05", "-mask", "CL2I"]
    command = [converter, *form, "-o", rinex, "-n", folder / "unused.nav", folder / "pocket.rtcm3"]
    subprocess.run(command, check=True, capture_output=True)
    return rinex


def _position(log: str, found: list[Place], recording: Recording) -> Outcome:
    errors = Errors.of(found, recording.place)
    passed = errors.count >= LEAST_FIXES and errors.rms <= MOST_M
    return Outcome(version(log), "its ranges of our B1I", passed, str(errors))
