"""RTKLIB positions from our RINEX files."""

from __future__ import annotations

import subprocess
from pathlib import Path

import debian
from outcome import Errors, Outcome, Place
from recordings import SKY_STATIC, Recording, fixes, places, synthesise

MOST_M = 5.0
SETTINGS = """pos1-posmode =single
pos1-frequency =l1
pos1-elmask =10
pos1-ionoopt =brdc
pos1-tropopt =saas
pos1-navsys ={systems}
out-solformat =llh
"""
BEIDOU = 32
_LABELS = (("BDSA", "GPSA"), ("BDSB", "GPSB"))


def run(folder: Path) -> list[Outcome]:
    """Observations and messages of our B1I recording."""
    program = debian.require("rnx2rtkp", "rtklib")
    recording = synthesise(SKY_STATIC, folder)
    own = fixes(recording, folder / "own")
    return [_outcome(program, recording, own)]


def _outcome(program: str, recording: Recording, own: Path) -> Outcome:
    theirs, ours = solve(program, own / "observations.rnx", own / "navigation.rnx"), places(own)
    apart = Errors.of(theirs, _mean(ours))
    passed = len(theirs) >= len(ours) // 2 > 0 and apart.rms <= MOST_M
    truth = Errors.of(ours, recording.place)
    figures = f"against the mean of ours: {apart}; ours against the truth: {truth}"
    return Outcome(f"RTKLIB {debian.version('rtklib')}", "our RINEX files", passed, figures)


def solve(program: str, observations: Path, navigation: Path) -> list[Place]:
    """Its positions from RINEX files of BDS; what it writes lies beside the observations."""
    settings, known = observations.with_suffix(".conf"), observations.with_suffix(".nav")
    settings.write_text(SETTINGS.format(systems=BEIDOU))
    known.write_text(_with_gps_labels(navigation.read_text()))
    solution = observations.with_suffix(".pos")
    command = [program, "-k", settings, "-o", solution, observations, known]
    subprocess.run(command, check=True, capture_output=True)
    return _places(solution)


def _with_gps_labels(text: str) -> str:
    """It knows the ionosphere by the names of GPS's parameters alone, and takes some of 2004
    otherwise, which are 6 m of height off."""
    for own, known in _LABELS:
        text = text.replace(f"\n{own}", f"\n{known}")
    return text


def _mean(found: list[Place]) -> Place:
    count = max(1, len(found))
    latitude, longitude, height = (sum(p[k] for p in found) / count for k in range(3))
    return latitude, longitude, height


def _places(solution: Path) -> list[Place]:
    rows = [r.split() for r in solution.read_text().splitlines() if r and r[0] != "%"]
    return [(float(r[2]), float(r[3]), float(r[4])) for r in rows]
