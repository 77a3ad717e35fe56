"""Pocket SDR receives our B1I and B1C."""

from __future__ import annotations

import os
import re
import subprocess
from collections import defaultdict
from pathlib import Path

from outcome import Errors, Outcome, PeerMissingError
from recordings import BOTH_BANDS, Recording, synthesise

VARIABLE = "POCKET_SDR"
MOST_M = 10.0
LEAST_FIXES = 5
SLOWER = 0.25
"""Its clock against ours: it drops samples where it cannot follow."""
_TRACKER = Path("app/pocket_trk/pocket_trk")


def run(folder: Path) -> list[Outcome]:
    """60 s of both bands: it must find every satellite, decode its messages and fix."""
    program = _program()
    recording = synthesise(BOTH_BANDS, folder)
    log = _receive(program, recording, folder / "pocket-sdr")
    return [_signals(log, recording), _position(log, recording)]


def _program() -> Path:
    root = os.environ.get(VARIABLE)
    program = Path(root or "") / _TRACKER
    if root is None or not program.is_file():
        raise PeerMissingError(
            f"set {VARIABLE} to a folder of Pocket SDR in which {_TRACKER} has been built"
        )
    return program


def _receive(program: Path, recording: Recording, folder: Path) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "pocket.log"
    log.unlink(missing_ok=True)
    beidou = [int(s[1:]) for s in recording.satellites if s[0] == "C"]
    third = ",".join(str(p) for p in beidou if 19 <= p < 59)
    everyone = ",".join(map(str, beidou))
    signals = ["-sig", "B1CP", "-prn", third, "-sig", "B1CD", "-prn", third]
    signals += ["-sig", "B1I", "-prn", everyone]
    form = ["-fmt", "CS8", "-f", "20", "-fo", "1568.259", "-tscale", str(SLOWER), "-ti", "0"]
    command = [program, *signals, *form, "-log", log, recording.data]
    subprocess.run(command, check=True, capture_output=True)
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


def _position(log: str, recording: Recording) -> Outcome:
    rows = [r.split(",") for r in log.splitlines() if r.startswith("$POS")]
    errors = Errors.of([(float(r[8]), float(r[9]), float(r[10])) for r in rows], recording.place)
    passed = errors.count >= LEAST_FIXES and errors.rms <= MOST_M
    first = f"first after {float(rows[0][1]):.1f} s; " if rows else ""
    return Outcome(version(log), "our B1I and B1C", passed, f"{first}{errors}")
